// SPDX-License-Identifier: MIT
#pragma once

#include <Eigen/Core>
#include <limits>
#include <vector>

namespace kissmap {

/// The part of a map that is wanted: a rectangle, a polygon and a range of heights, all at once.
/// Borders of the rectangle and of the heights belong to it. The default holds everything.
struct CropRegion {
  static constexpr double infinity = std::numeric_limits<double>::infinity();

  Eigen::Vector2d low = Eigen::Vector2d::Constant(-infinity);  ///< m, map frame
  Eigen::Vector2d high = Eigen::Vector2d::Constant(infinity);
  double z_min = -infinity;  ///< m
  double z_max = infinity;
  /// Corners in order, either way round, m, map frame; what is inside by the even-odd rule. Empty:
  /// no polygon.
  std::vector<Eigen::Vector2d> polygon;

  bool contains(const Eigen::Vector3d& point) const;
};

/// Throws Error(usage) unless low < high, z_min < z_max, and a polygon has three corners or more.
void require_valid(const CropRegion& region);

}  // namespace kissmap
