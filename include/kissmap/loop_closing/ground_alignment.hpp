// SPDX-License-Identifier: MIT
#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>

#include "kissmap/geometry/rigid3.hpp"

namespace kissmap {

/// Levels a local map: rotation about x and y and a shift along z that bring its ground to z = 0
/// (METHOD section 3.1). Samples of the ground are the lowest points of columns of 5 x 5 m; a
/// plane is fitted to them by iteratively reweighted least squares, from the level plane at their
/// median height. Empty where fewer than three columns hold points or the plane tilts by more than
/// 45 degrees: there is no ground then.
/// `points` in the local_map frame [m]. Pure.
std::optional<Rigid3> ground_from_local_map(std::span<const Eigen::Vector3f> points);

}  // namespace kissmap
