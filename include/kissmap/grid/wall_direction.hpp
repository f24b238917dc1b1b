// SPDX-License-Identifier: MIT
#pragma once

#include <Eigen/Core>
#include <span>

namespace kissmap {

/// The direction most walls run along, or square to it: an angle from the x axis [rad] in
/// (-pi/4, pi/4]. `normals` of surfaces in a level frame; those of floors do not count. Zero where
/// no direction stands out. Pure.
double wall_direction(std::span<const Eigen::Vector3f> normals);

}  // namespace kissmap
