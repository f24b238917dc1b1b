// SPDX-License-Identifier: MIT
#pragma once

#include <memory>

#include "formats/sensors/hdl_64e_calibration.hpp"
#include "formats/sensors/packet_decoder.hpp"

namespace kissmap {

/// Decoder of the data packets of Velodyne's HDL-64E (1206 bytes), S2 and S3, one or two returns,
/// and S1. Points are in the maker's frame: x forward at azimuth 0, y left, z up [m]. Intensities
/// are corrected for the focal distance, within the limits of the calibration.
///
/// S2 and S3 tell the time past the hour, and their pace tells them apart; where the numbers in
/// its place do not go on as a clock does, it is an S1, whose packets are dated by the receiver's
/// clock and take the S2's pace. Two returns at one distance are one point.
///
/// Refused by name: other Velodyne sensors.
std::unique_ptr<PacketDecoder> make_hdl_64e_decoder(const Hdl64eCalibration& calibration);

}  // namespace kissmap
