// SPDX-License-Identifier: MIT
#include "grid/bent_ray.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

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

/// Leaves out corners that a straight piece passes within the tolerance: the longest piece from
/// each corner that is kept.
void straighten(std::vector<Eigen::Vector3d>& corners) {
  std::size_t kept = 0;  // corners[kept] is where the piece begins
  double steepest = std::numeric_limits<double>::infinity();
  double flattest = -steepest;  // slopes of all pieces that pass what lies between
  for (std::size_t i = 1; i < corners.size(); ++i) {
    const Eigen::Vector3d way = corners[i] - corners[kept];
    const double length = way.head<2>().norm();
    const double slope = way.z() / length;
    if (!(slope >= flattest && slope <= steepest)) {  // as is NaN, of a piece of no length
      corners[++kept] = corners[i - 1];
      const Eigen::Vector3d next = corners[i] - corners[kept];
      const double next_length = next.head<2>().norm();
      flattest = (next.z() - tolerance) / next_length;
      steepest = (next.z() + tolerance) / next_length;
      continue;
    }
    flattest = std::max(flattest, (way.z() - tolerance) / length);
    steepest = std::min(steepest, (way.z() + tolerance) / length);
  }
  corners[++kept] = corners.back();
  corners.resize(kept + 1);
}

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
  if (corners.size() > 2) straighten(corners);
}

}  // namespace kissmap
