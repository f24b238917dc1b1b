// SPDX-License-Identifier: MIT
#pragma once

#include <cmath>
#include <filesystem>
#include <numbers>
#include <random>
#include <vector>

#include "support/block_world.hpp"
#include "support/small_log.hpp"

namespace kissmap {

/// Where a sensor is that goes round a yard of houses, 12 m from its middle, `steps` scans a lap.
inline Rigid3 yard_from_lidar(int i, int steps) {
  const double angle = 2.0 * std::numbers::pi * i / steps;
  Rigid3 pose;
  pose.rotation = Eigen::AngleAxisd(angle + 0.5 * std::numbers::pi, Eigen::Vector3d::UnitZ());
  pose.translation = {12.0 * std::cos(angle), 12.0 * std::sin(angle), 1.7};
  return pose;
}

/// A lap and three quarters of it as a log: it meets its own way. Points are seen exactly, through
/// walls; other ones in each scan.
inline void write_yard_log(const std::filesystem::path& folder, int steps = 80) {
  constexpr float reach = 40.0F;  // m
  constexpr unsigned every = 16;
  std::filesystem::create_directories(folder);
  const std::vector<Eigen::Vector3f> world = block_world(21, 45.0F);
  std::mt19937 random(7);
  for (int i = 0; i < 7 * steps / 4; ++i) {
    const Rigid3 pose = yard_from_lidar(i, steps);
    std::vector<Eigen::Vector3f> seen;
    for (const Eigen::Vector3f& point : world) {
      if (random() % every > 0) continue;
      const float distance = (point - pose.translation.cast<float>()).norm();
      if (distance < reach) seen.push_back(point);
    }
    write_pcd(folder / scan_name(i), moved(pose.inverse(), seen));
  }
}

}  // namespace kissmap
