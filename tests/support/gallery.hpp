// SPDX-License-Identifier: MIT
#pragma once

#include <cmath>
#include <cstdint>
#include <random>
#include <vector>

#include "kissmap/cloud/scan.hpp"
#include "support/random_clouds.hpp"

namespace kissmap {

inline constexpr std::int64_t tenth_second = 100'000'000;

/// A sensor gliding through a 60 m gallery of columns, seen exactly, without noise or sweep time.
class Gallery {
 public:
  Gallery() {
    std::mt19937 random(61);
    std::uniform_real_distribution<float> jitter(-0.4F, 0.4F);
    for (int i = 0; i < 40; ++i) {
      const Eigen::Vector2f foot(1.5F * static_cast<float>(i) - 5.0F + jitter(random),
                                 (i % 2 == 0 ? 4.0F : -4.0F) + jitter(random));
      for (int k = 0; k < 240; ++k) {
        const float angle = static_cast<float>(k % 24) * 0.2618F;
        const float height = -1.5F + 0.4F * static_cast<float>(k / 24);
        world_.emplace_back(
            foot.x() + 0.4F * std::cos(angle), foot.y() + 0.4F * std::sin(angle), height);
      }
    }
  }

  static Rigid3 map_from_lidar(int i) {
    Twist twist = Twist::Zero();
    twist(0) = 0.4 * i;
    twist(5) = 0.002 * i;
    return exp(twist);
  }

  Scan scan(int i) const {
    Scan scan;
    scan.stamp_ns = i * tenth_second;
    scan.points = moved(map_from_lidar(i).inverse(), world_);
    return scan;
  }

 private:
  std::vector<Eigen::Vector3f> world_;
};

}  // namespace kissmap
