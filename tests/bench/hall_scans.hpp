// SPDX-License-Identifier: MIT
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <random>
#include <utility>
#include <vector>

namespace kissmap {

inline constexpr float max_range = 50.0F;

struct Box {
  Eigen::Vector3f low, high;
};

struct SimulatedScan {
  Eigen::Vector3f sensor;
  std::vector<Eigen::Vector3f> ends;  // map frame
  std::vector<std::uint8_t> is_hit;
};

/// Distance along a unit direction to what is met first in a hall of 90 x 60 x 10 m with shelves.
class Hall {
 public:
  Hall() {
    std::mt19937 random(3);
    std::uniform_real_distribution<float> unit(0.0F, 1.0F);
    for (int i = 0; i < 60; ++i) {
      const Eigen::Vector3f low(90 * unit(random) - 45, 60 * unit(random) - 30, 0.0F);
      if (std::abs(low.y()) < 4.0F) continue;  // the aisle driven along
      const Eigen::Vector3f size(
          0.3F + 3 * unit(random), 0.3F + 2 * unit(random), 0.5F + 4 * unit(random));
      boxes_.push_back({low, low + size});
    }
  }

  float range(const Eigen::Vector3f& from, const Eigen::Vector3f& direction) const {
    const Eigen::Array3f inverse = direction.array().inverse();
    const auto crossing = [&](const Box& box) {
      const Eigen::Array3f a = (box.low - from).array() * inverse;
      const Eigen::Array3f b = (box.high - from).array() * inverse;
      return std::pair(a.min(b).maxCoeff(), a.max(b).minCoeff());
    };
    float nearest = crossing({{-45, -30, 0}, {45, 30, 10}}).second;
    for (const Box& box : boxes_) {
      const auto [enter, leave] = crossing(box);
      if (enter > 0.0F && enter < leave) nearest = std::min(nearest, enter);
    }
    return nearest;
  }

 private:
  std::vector<Box> boxes_;
};

inline SimulatedScan simulate(const Hall& hall, int number, int scans) {
  std::mt19937 random(static_cast<unsigned>(number));
  std::normal_distribution<float> noise(0.0F, 0.02F);
  SimulatedScan scan;
  const float way = static_cast<float>(number) / static_cast<float>(scans);
  scan.sensor = {-20.0F + 40.0F * way, 0.5F * std::sin(6.0F * way), 1.7F};
  const float heading = 0.3F * std::sin(9.0F * way);
  for (int column = 0; column < 1024; ++column) {
    const float azimuth = heading + 6.2831853F * static_cast<float>(column) / 1024.0F;
    for (int ring = 0; ring < 64; ++ring) {
      const float elevation = 0.3927F * (2.0F * static_cast<float>(ring) / 63.0F - 1.0F);  // 22.5
      const Eigen::Vector3f direction(std::cos(azimuth) * std::cos(elevation),
                                      std::sin(azimuth) * std::cos(elevation),
                                      std::sin(elevation));
      const float range = hall.range(scan.sensor, direction) + noise(random);
      scan.is_hit.push_back(range < max_range ? 1 : 0);
      scan.ends.emplace_back(scan.sensor + std::min(range, max_range) * direction);
    }
  }
  return scan;
}

}  // namespace kissmap
