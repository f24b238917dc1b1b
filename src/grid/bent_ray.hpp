// SPDX-License-Identifier: MIT
#pragma once

#include <Eigen/Core>
#include <vector>

#include "kissmap/grid/floor_map.hpp"

namespace kissmap {

/// A straight ray as it runs through a frame whose z is the height above the floor: corners of a
/// line of straight pieces, from start to end, nowhere more than two centimetres off in height
/// (where the floor is smooth over half a metre). `corners` is overwritten.
void bend_ray(const Eigen::Vector3d& start,
              const Eigen::Vector3d& end,
              const FloorMap& floor,
              std::vector<Eigen::Vector3d>& corners);

}  // namespace kissmap
