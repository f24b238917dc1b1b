// SPDX-License-Identifier: MIT
#pragma once

#include <memory>
#include <vector>

#include "formats/sensors/hesai_tables.hpp"
#include "formats/sensors/packet_decoder.hpp"

namespace kissmap {

/// Angles of one unit by laser, from the file that came with it; empty: those typical of its model.
using HesaiAngles = std::vector<HesaiAngle>;

/// Decoder of Hesai's data packets: PandarXT-32, PandarXT-16, XT32M2X, QT128C2X, Pandar64 and
/// Pandar40P, told apart by the packets themselves, with one, two or three returns. Points are in
/// the maker's frame: y forward at azimuth 0, x right, z up [m]; a return at the distance of
/// another one of the same shot is left out. Intensities are reflectivities 0..255. Azimuths of
/// shots follow from that of their block, the time of firing in it and the speed of the motor.
///
/// Refused by name: other Hesai, angles for another number of lasers, the QT-128 with an order of
/// channels of its own.
std::unique_ptr<PacketDecoder> make_hesai_decoder(HesaiAngles unit = {});

}  // namespace kissmap
