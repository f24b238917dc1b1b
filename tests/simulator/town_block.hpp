// SPDX-License-Identifier: MIT
#pragma once

#include <Eigen/Core>

#include "simulator/random.hpp"
#include "simulator/world.hpp"

namespace kissmap::simulator {

/// The land between four kerbs.
struct Block {
  Eigen::Vector2d low = Eigen::Vector2d::Zero();   ///< m, south-western kerb corner
  Eigen::Vector2d high = Eigen::Vector2d::Zero();  ///< m
  double sidewalk_width = 3.0;                     ///< m
  double parking_width = 2.0;                      ///< m, outside the kerb
  bool park = false;                               ///< trees and hedges instead of houses
  bool passages = false;  ///< free ways, 4 m wide, through the middles of the southern and
                          ///< northern rows of houses, and a free middle of the courtyard
};

/// Adds a block with its houses or park, street furniture and parked cars.
void add_block(World& world, const Block& block, Random& random);

}  // namespace kissmap::simulator
