// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cstddef>
#include <span>

namespace kissmap {

/// Where a laser points: elevation, and how far it is turned clockwise from its block [deg].
struct HesaiAngle {
  double elevation_deg = 0.0;
  double azimuth_deg = 0.0;
};

/// A model with its typical angles: those of a unit, from its own file of angles, differ by up to
/// some tenths of a degree.
struct HesaiModel {
  const char* name = "";
  std::size_t lasers = 0;
  std::size_t blocks = 0;  ///< in a packet
  std::span<const HesaiAngle> angles;
  bool stamp_is_last = true;      ///< the packet's stamp belongs to its last block, not its first
  double stamped_block_us = 0.0;  ///< from the stamp to the beginning of the block it belongs to
  double column_us = 0.0;         ///< from column to column
  /// When each laser fires after its block begins [us]; the QT-128 has two orders in turns.
  std::array<std::span<const double>, 2> firing_us;
};

namespace hesai {
extern const HesaiModel xt_16;
extern const HesaiModel xt_32;
extern const HesaiModel xt_32m;
extern const HesaiModel qt_128;
extern const HesaiModel pandar_64;
extern const HesaiModel pandar_40p;
}  // namespace hesai

}  // namespace kissmap
