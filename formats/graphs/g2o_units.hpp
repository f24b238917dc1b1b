// SPDX-License-Identifier: MIT
#pragma once

#include "kissmap/graph/pose_graph.hpp"

namespace kissmap {

/// Information as SE3 lines of g2o hold it, over (translation; vector part of the quaternion),
/// which is half the rotation vector. Powers of two: nothing is lost either way.
inline Information information_from_g2o(Information information) {
  information.rightCols<3>() *= 0.5;
  information.bottomRows<3>() *= 0.5;
  return information;
}
inline Information information_to_g2o(Information information) {
  information.rightCols<3>() *= 2.0;
  information.bottomRows<3>() *= 2.0;
  return information;
}

/// Rows of the information that SE2 lines hold: x, y, theta.
inline constexpr int planar_rows[] = {0, 1, 5};

/// Odometry joins consecutive ids.
inline EdgeKind kind_between(std::int64_t from, std::int64_t to) {
  const std::int64_t step = from < to ? to - from : from - to;
  return step == 1 ? EdgeKind::odometry : EdgeKind::closure;
}

}  // namespace kissmap
