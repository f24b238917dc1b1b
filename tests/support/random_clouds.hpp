// SPDX-License-Identifier: MIT
#pragma once

#include <Eigen/Core>
#include <random>
#include <vector>

#include "kissmap/geometry/rigid3.hpp"

namespace kissmap {

inline std::vector<Eigen::Vector3f> uniform_cloud(std::mt19937& random,
                                                  std::size_t count,
                                                  float half_extent) {
  std::uniform_real_distribution<float> coordinate(-half_extent, half_extent);
  std::vector<Eigen::Vector3f> points(count);
  for (Eigen::Vector3f& p : points)
    p = {coordinate(random), coordinate(random), coordinate(random)};
  return points;
}

/// Points on the walls, floor and ceiling of a 20 x 14 x 4 m room with a pillar, seen from near its
/// middle: enough structure to fix all six degrees of freedom.
inline std::vector<Eigen::Vector3f> room_cloud(std::mt19937& random, std::size_t count) {
  std::uniform_real_distribution<float> unit(-1.0F, 1.0F);
  std::uniform_int_distribution<int> side(0, 7);
  std::vector<Eigen::Vector3f> points;
  while (points.size() < count) {
    const float u = unit(random);
    const float v = unit(random);
    switch (side(random)) {
      case 0:
        points.emplace_back(10.0F, 7.0F * u, 2.0F * v);
        break;
      case 1:
        points.emplace_back(-10.0F, 7.0F * u, 2.0F * v);
        break;
      case 2:
        points.emplace_back(10.0F * u, 7.0F, 2.0F * v);
        break;
      case 3:
        points.emplace_back(10.0F * u, -7.0F, 2.0F * v);
        break;
      case 4:
        points.emplace_back(10.0F * u, 7.0F * v, -2.0F);
        break;
      case 5:
        points.emplace_back(10.0F * u, 7.0F * v, 2.0F);
        break;
      case 6:
        points.emplace_back(4.0F, 2.0F + 0.5F * u, 2.0F * v);
        break;
      default:
        points.emplace_back(4.0F + 0.5F * u, 1.5F, 2.0F * v);
        break;
    }
  }
  return points;
}

inline std::vector<Eigen::Vector3f> moved(const Rigid3& b_from_a,
                                          const std::vector<Eigen::Vector3f>& in_a) {
  std::vector<Eigen::Vector3f> in_b;
  in_b.reserve(in_a.size());
  for (const Eigen::Vector3f& p : in_a) in_b.push_back((b_from_a * p.cast<double>()).cast<float>());
  return in_b;
}

}  // namespace kissmap
