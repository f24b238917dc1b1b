// SPDX-License-Identifier: MIT
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <numbers>
#include <vector>

#include "simulator/world.hpp"

namespace kissmap::simulator {

struct GarageOptions {
  double length = 60.0;                                 ///< m, along x, inside the outer walls
  double width = 34.0;                                  ///< m, along y
  double storey = 3.2;                                  ///< m from floor to floor
  double slab = 0.3;                                    ///< m, thickness of floors
  double ramp_slope = 10.0 * std::numbers::pi / 180.0;  ///< rad
  double ramp_width = 3.5;                              ///< m, between the middles of its walls
  double aisle = 6.0;                                   ///< m
  double bay = 5.0;                                     ///< m, depth of the parking bays
  double taken_share = 0.6;                             ///< of the bays
};

/// A car park of two levels, 0 and 1: on both, parking bays along the outer walls, an aisle around
/// a core, pillars. In the core two straight ramps side by side, driven towards +x: the northern
/// one up, the southern one down. Walls stand wherever the floor has a step. Level 0 is at z = 0;
/// the inner corner of the outer walls is the origin. The ramps belong to both levels.
struct Garage {
  World world;
  GarageOptions options;
  /// On the road, right where a car drives: round level 0, up, round level 1, down, round level 0.
  std::vector<Eigen::Vector3d> way;
};

/// The same garage for the same seed and options. Throws Error(usage) where the ramps do not fit
/// between the aisles.
Garage make_garage(std::uint64_t seed, const GarageOptions& options = {});

}  // namespace kissmap::simulator
