// SPDX-License-Identifier: MIT
#pragma once

#include <memory>

#include "formats/sensors/packet_decoder.hpp"

namespace kissmap {

/// Decoder of Velodyne's data packets (1206 bytes, usually to UDP port 2368): VLP-16, Puck Hi-Res,
/// HDL-32E, VLP-32C and VLS-128, told apart by the packets themselves; strongest, last and dual
/// return. Points are in the maker's frame: x forward at azimuth 0, y left, z up [m]; the second of
/// two returns at one distance is left out. Intensities are 0..255.
///
/// Refused by name: HDL-64E (every unit has a calibration of its own), VLP-32A and B (one product
/// byte, two tables of angles), Velarray, and modes of more than two returns or other records.
///
/// Packets tell the time past the hour. The hour is that which is nearest to the host's time at the
/// first packet, and nearest to the time gone by since, later on.
std::unique_ptr<PacketDecoder> make_velodyne_decoder();

}  // namespace kissmap
