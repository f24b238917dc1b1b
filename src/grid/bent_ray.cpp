// SPDX-License-Identifier: MIT
#include "grid/bent_ray.hpp"

#include <algorithm>
#include <cmath>

namespace kissmap {
namespace {

constexpr double tolerance = 0.01;  // m
constexpr double longest = 2.0;     // m of a piece, in the plane, where the floor is not level
constexpr double shortest = 0.25;   // m, of a piece that is divided no more

Eigen::Vector3d above_floor(const Eigen::Vector3d& point, const FloorMap& floor) {
  return {point.x(), point.y(), point.z() - floor.height(point.x(), point.y())};
}

struct Bender {
  const FloorMap& floor;
  std::vector<Eigen::Vector3d>& corners;

  /// Adds the corners after `from` up to `to`; both lie on the bent ray.
  void divide(const Eigen::Vector3d& start,
              const Eigen::Vector3d& end,
              const Eigen::Vector3d& from,
              const Eigen::Vector3d& to) {
    const Eigen::Vector3d middle = 0.5 * (start + end);
    const Eigen::Vector3d bent = above_floor(middle, floor);
    const bool straight = std::abs(bent.z() - 0.5 * (from.z() + to.z())) < tolerance;
    if (straight || (end - start).head<2>().norm() < shortest) {
      corners.push_back(to);
      return;
    }
    divide(start, middle, from, bent);
    divide(middle, end, bent, to);
  }
};

}  // namespace

void bend_ray(const Eigen::Vector3d& start,
              const Eigen::Vector3d& end,
              const FloorMap& floor,
              std::vector<Eigen::Vector3d>& corners) {
  corners.clear();
  corners.push_back(above_floor(start, floor));
  if (floor.highest() - floor.lowest() < tolerance) {
    corners.push_back(above_floor(end, floor));
    return;
  }
  const double length = (end - start).head<2>().norm();
  const int pieces = std::max(1, static_cast<int>(std::ceil(length / longest)));
  Bender bender{floor, corners};
  Eigen::Vector3d from = start;
  for (int i = 1; i <= pieces; ++i) {
    const Eigen::Vector3d to =
        i == pieces ? end : Eigen::Vector3d(start + (end - start) * i / pieces);
    bender.divide(from, to, corners.back(), above_floor(to, floor));
    from = to;
  }
}

}  // namespace kissmap
