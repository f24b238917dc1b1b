// SPDX-License-Identifier: MIT
#pragma once

#include <cmath>
#include <cstddef>
#include <vector>

#include "kissmap/geometry/rigid3.hpp"

namespace kissmap {

/// A smooth way in all six degrees of freedom, about `step` metres a pose; a closed form of sines,
/// so that any program can repeat it. `disturbance` adds drift and noise-like error to it.
inline std::vector<Rigid3> winding_way(std::size_t poses, double step, double disturbance = 0.0) {
  std::vector<Rigid3> way(poses);
  for (std::size_t i = 0; i < poses; ++i) {
    const auto k = static_cast<double>(i);
    const double d = disturbance;
    Rigid3& pose = way[i];
    pose.translation = {step * k * (1.0 + 0.01 * d) + d * 0.05 * std::sin(1.3 * k),
                        20.0 * step * std::sin(0.05 * k) + d * 0.03 * std::cos(2.1 * k),
                        5.0 * step * std::sin(0.02 * k) + d * 0.02 * std::sin(0.7 * k)};
    const double yaw = 0.8 * std::sin(0.05 * k) + d * 0.01 * std::sin(0.9 * k);
    const double pitch = 0.1 * std::sin(0.03 * k) + d * 0.004 * std::cos(1.1 * k);
    pose.rotation = Eigen::AngleAxisd(yaw, Eigen::Vector3d::UnitZ()) *
                    Eigen::AngleAxisd(pitch, Eigen::Vector3d::UnitY());
  }
  return way;
}

}  // namespace kissmap
