// SPDX-License-Identifier: MIT
#pragma once

#include <Eigen/Core>
#include <cmath>
#include <limits>
#include <numbers>
#include <random>
#include <vector>

#include "unit/occupancy/ray_oracle.hpp"

namespace kissmap {

struct TestBox {
  Eigen::Vector3f low, high;
};

/// A floor at a height, boxes on it, and a sensor with rings.
struct GrazingWorld {
  float floor = 0.0F;
  std::vector<TestBox> boxes;

  /// m to what a ray meets first; infinite if nothing.
  float range(const Eigen::Vector3f& from, const Eigen::Vector3f& direction) const {
    float nearest = std::numeric_limits<float>::infinity();
    if (direction.z() < 0.0F) nearest = (floor - from.z()) / direction.z();
    for (const TestBox& box : boxes) {
      const Eigen::Array3f a = (box.low - from).array() / direction.array();
      const Eigen::Array3f b = (box.high - from).array() / direction.array();
      const float enter = a.min(b).maxCoeff();
      if (enter > 0.0F && enter < a.max(b).minCoeff()) nearest = std::min(nearest, enter);
    }
    return nearest;
  }
};

struct Rings {
  std::vector<double> elevations;  // degrees
  double first_azimuth = -180.0, last_azimuth = 180.0, azimuth_step = 1.0;
  float max_range = 100.0F;
  float noise = 0.0F;  // m, standard deviation along the ray
};

inline std::vector<double> steps_between(double first, double last, double step) {
  std::vector<double> values;
  for (int i = 0; first + i * step <= last + 1e-9; ++i) values.push_back(first + i * step);
  return values;
}

/// Rays without a hit end at max_range.
inline std::vector<TestRay> look(const GrazingWorld& world,
                                 const Eigen::Vector3f& sensor,
                                 const Rings& rings,
                                 std::mt19937& random) {
  constexpr double radians = std::numbers::pi / 180.0;
  std::normal_distribution<float> normal;
  std::vector<TestRay> rays;
  for (double a = rings.first_azimuth; a < rings.last_azimuth; a += rings.azimuth_step) {
    for (const double e : rings.elevations) {
      const Eigen::Vector3f direction(
          static_cast<float>(std::cos(a * radians) * std::cos(e * radians)),
          static_cast<float>(std::sin(a * radians) * std::cos(e * radians)),
          static_cast<float>(std::sin(e * radians)));
      const float range = world.range(sensor, direction);
      const bool hit = range < rings.max_range;
      const float seen = hit ? range + rings.noise * normal(random) : rings.max_range;
      rays.push_back({sensor, sensor + seen * direction, hit, 0.0F});
    }
  }
  return rays;
}

}  // namespace kissmap
