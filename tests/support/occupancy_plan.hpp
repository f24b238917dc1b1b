// SPDX-License-Identifier: MIT
#pragma once

#include <Eigen/Core>
#include <cmath>
#include <cstdint>
#include <functional>
#include <vector>

#include "simulator/plan_truth.hpp"

namespace kissmap {

/// A pose in the plane: x, y [m], yaw [rad].
struct Pose2 {
  double x = 0.0;
  double y = 0.0;
  double yaw = 0.0;

  /// a_from_c = a_from_b * b_from_c.
  Pose2 operator*(const Pose2& other) const {
    const double c = std::cos(yaw);
    const double s = std::sin(yaw);
    return {x + c * other.x - s * other.y, y + s * other.x + c * other.y, yaw + other.yaw};
  }
  Pose2 inverse() const {
    const double c = std::cos(yaw);
    const double s = std::sin(yaw);
    return {-c * x - s * y, s * x - c * y, -yaw};
  }
};

enum class PlanCell : std::uint8_t { free, occupied, unknown };

/// A 2D map as robots use it. Cell (column, row) covers origin + resolution * [column, column + 1)
/// x [row, row + 1); rows are stored one after the other, the one with the lowest y first.
struct OccupancyPlan {
  int width = 0;                                     ///< columns
  int height = 0;                                    ///< rows
  double resolution = 0.05;                          ///< m
  Eigen::Vector2d origin = Eigen::Vector2d::Zero();  ///< m, lower left corner
  std::vector<PlanCell> cells;

  std::size_t index(int column, int row) const {
    return static_cast<std::size_t>(row) * static_cast<std::size_t>(width) +
           static_cast<std::size_t>(column);
  }
  bool contains(int column, int row) const {
    return column >= 0 && column < width && row >= 0 && row < height;
  }
};

/// What a perfect map of static solids looks like: occupied where any touches the band, else free
/// where `inside` holds for the cell's middle, else unknown.
inline OccupancyPlan exact_plan(const simulator::PlanTruth& truth,
                                const std::function<bool(const Eigen::Vector2d&)>& inside) {
  OccupancyPlan plan;
  plan.width = truth.frame.columns;
  plan.height = truth.frame.rows;
  plan.resolution = truth.frame.resolution;
  plan.origin = truth.frame.lower_left;
  for (int row = 0; row < plan.height; ++row) {
    for (int column = 0; column < plan.width; ++column) {
      const Eigen::Vector2d middle =
          truth.frame.corner(column, row) + Eigen::Vector2d::Constant(0.5 * plan.resolution);
      plan.cells.push_back(truth.touched(column, row) ? PlanCell::occupied
                           : inside(middle)           ? PlanCell::free
                                                      : PlanCell::unknown);
    }
  }
  return plan;
}

}  // namespace kissmap
