// SPDX-License-Identifier: MIT
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "simulator/world.hpp"

namespace kissmap::simulator {

/// A street around a block, up one side of a hill and down the other: 400 m along its middle, in
/// streets along x up to 7.5 degrees steep, along y 2.75 degrees, nowhere 8. Kerbs of 0.12 m,
/// houses, trees, poles and parked cars on both sides; nothing moves. The street's middle passes
/// through the origin at height 0.
///
/// The ground is a sum of two profiles, height(x, y) = f(x) + g(y), both of straight parts: every
/// rectangle between their kinks is exactly planar.
struct Hill {
  World world;
  double length = 120.0;  ///< m, of the streets along x, between the middles of those along y
  double width = 80.0;    ///< m

  /// On the road, counter-clockwise on the right-hand lane: once round and half the way again.
  std::vector<Eigen::Vector3d> way;
};

/// The same hill for the same seed; the ground does not depend on it.
Hill make_hill(std::uint64_t seed);

}  // namespace kissmap::simulator
