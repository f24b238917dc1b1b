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

  /// Adds the corners after `from` up to `to`; both lie on the bent ray, `length` m apart in the
  /// plane.
  void divide(const Eigen::Vector3d& start,
              const Eigen::Vector3d& end,
              double length,
              const Eigen::Vector3d& from,
              const Eigen::Vector3d& to) {
    const Eigen::Vector3d middle = 0.5 * (start + end);
    const Eigen::Vector3d bent = above_floor(middle, floor);
    const bool straight = std::abs(bent.z() - 0.5 * (from.z() + to.z())) < tolerance;
    if (straight || length < shortest) {
      corners.push_back(to);
      return;
    }
    divide(start, middle, 0.5 * length, from, bent);
    divide(middle, end, 0.5 * length, bent, to);
  }
};

/// Distances in the plane along a ray, from one coordinate of places on it.
class Along {
 public:
  Along(const Eigen::Vector2d& way, double length) {
    axis_ = std::abs(way.x()) < std::abs(way.y()) ? 1 : 0;
    per_step_ = length / way[axis_];
  }
  double between(const Eigen::Vector3d& from, const Eigen::Vector3d& to) const {
    return (to[axis_] - from[axis_]) * per_step_;
  }

 private:
  Eigen::Index axis_ = 0;
  double per_step_ = 0.0;
};

/// Leaves out corners that a straight piece passes within the tolerance: the longest piece from
/// each corner that is kept.
void straighten(const Along& along, std::vector<Eigen::Vector3d>& corners) {
  std::size_t kept = 0;  // corners[kept] is where the piece begins
  double steepest = std::numeric_limits<double>::infinity();
  double flattest = -steepest;  // slopes of all pieces that pass what lies between
  for (std::size_t i = 1; i < corners.size(); ++i) {
    const double rise = corners[i].z() - corners[kept].z();
    const double per_metre = 1.0 / along.between(corners[kept], corners[i]);
    const double slope = rise * per_metre;
    if (!(slope >= flattest && slope <= steepest)) {  // as is NaN, of a piece of no length
      corners[++kept] = corners[i - 1];
      const double next_rise = corners[i].z() - corners[kept].z();
      const double per_next_metre = 1.0 / along.between(corners[kept], corners[i]);
      flattest = (next_rise - tolerance) * per_next_metre;
      steepest = (next_rise + tolerance) * per_next_metre;
      continue;
    }
    flattest = std::max(flattest, (rise - tolerance) * per_metre);
    steepest = std::min(steepest, (rise + tolerance) * per_metre);
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
  const Eigen::Vector3d way = end - start;
  const double length = way.head<2>().norm();
  const int pieces = std::max(1, static_cast<int>(std::ceil(length / longest)));
  const double share = 1.0 / pieces;
  Bender bender{floor, corners};
  Eigen::Vector3d from = start;
  for (int i = 1; i <= pieces; ++i) {
    const Eigen::Vector3d to = i == pieces ? end : Eigen::Vector3d(start + i * share * way);
    bender.divide(from, to, share * length, corners.back(), above_floor(to, floor));
    from = to;
  }
  if (corners.size() > 2) straighten(Along(way.head<2>(), length), corners);
}

}  // namespace kissmap
