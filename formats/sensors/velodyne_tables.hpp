// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

namespace kissmap {

/// Where a laser points: elevation, and how far it is turned against the azimuth of its block
/// (subtracted from it) [deg].
struct VelodyneLaser {
  double elevation_deg = 0.0;
  double turned_deg = 0.0;
};

/// In which order and at which pace the lasers of a model fire.
enum class VelodynePace : std::uint8_t { sixteen_twice, thirty_two_pairs, thirty_two, eights };

struct VelodyneModel {
  std::uint8_t product = 0;  ///< last byte of its packets
  const char* name = "";
  double unit_m = 0.0;  ///< of distances
  VelodynePace pace = VelodynePace::sixteen_twice;
  std::span<const VelodyneLaser> lasers;
};

/// The model of a product byte; null for one without a table here.
const VelodyneModel* find_velodyne_model(std::uint8_t product);

/// The Alpha Prime takes the time of 20 groups of eight lasers for a firing of all: 53.3 us in
/// early firmwares, 57.8 us in later ones, and values between in recordings. This is where nothing
/// tells.
inline constexpr double velodyne_groups_per_firing = 20.0;
inline constexpr double alpha_prime_group_us = 8.0 / 3.0;

/// Time of a shot after the packet's time stamp, for block 0..11 of a packet of single returns and
/// place 0..31 in it [us]. `group_us` counts for the Alpha Prime alone.
double velodyne_shot_us(VelodynePace pace, std::size_t block, std::size_t place, double group_us);

}  // namespace kissmap
