// SPDX-License-Identifier: MIT
#include "simulator/motion.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace kissmap::simulator {
namespace {

// Uniform cubic B-spline; the ends repeat, so the motion starts and ends at rest.
PoseVector spline(const std::vector<PoseVector>& control, double position) {
  const auto last = static_cast<double>(control.size() - 1);
  const double clamped = std::clamp(position, -2.0, last + 2.0);
  const double whole = std::floor(clamped);
  const double u = clamped - whole;
  const auto at = [&](double index) -> const PoseVector& {
    return control[static_cast<std::size_t>(std::clamp(index, 0.0, last))];
  };
  const double v = 1.0 - u;
  return (v * v * v * at(whole - 1) + (3 * u * u * u - 6 * u * u + 4) * at(whole) +
          (3 * v * v * v - 6 * v * v + 4) * at(whole + 1) + u * u * u * at(whole + 2)) /
         6.0;
}

PoseVector shaking(const std::vector<Wobble>& wobbles, double time) {
  PoseVector sum = PoseVector::Zero();
  for (const Wobble& wobble : wobbles) {
    const double angle = 2.0 * std::numbers::pi * wobble.frequency * time + wobble.phase;
    sum += std::sin(angle) * wobble.amplitude;
  }
  return sum;
}

}  // namespace

Rigid3 rigid_from(const PoseVector& pose) {
  const Eigen::Quaterniond rotation = Eigen::AngleAxisd(pose[5], Eigen::Vector3d::UnitZ()) *
                                      Eigen::AngleAxisd(pose[4], Eigen::Vector3d::UnitY()) *
                                      Eigen::AngleAxisd(pose[3], Eigen::Vector3d::UnitX());
  return {rotation, pose.head<3>()};
}

double Motion::duration() const {
  return static_cast<double>(control.size() - 1) * interval;
}

Rigid3 Motion::world_from_lidar(double time) const {
  const Rigid3 world_from_body = rigid_from(spline(control, time / interval));
  const Rigid3 body_from_shaken_body = rigid_from(shaking(wobbles, time));
  return world_from_body * body_from_shaken_body * body_from_lidar;
}

}  // namespace kissmap::simulator
