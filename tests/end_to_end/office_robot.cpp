// SPDX-License-Identifier: MIT
#include "end_to_end/office_robot.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace kissmap {

OccupancyPlan LaserRobotInTheOffice::exact_plan(double z_min, double z_max) const {
  const simulator::PlanFrame frame{{-1.0, -1.0}, 0.05, 840, 540};
  const Eigen::AlignedBox2d inside(Eigen::Vector2d::Zero(),
                                   Eigen::Vector2d(office_.options.length, office_.options.width));
  return kissmap::exact_plan(solids_in_band(office_.world, frame, {z_min, z_max, 0}),
                             [&](const Eigen::Vector2d& place) { return inside.contains(place); });
}

Localised LaserRobotInTheOffice::localise(const OccupancyPlan& plan,
                                          const Pose2& world_from_plan,
                                          std::uint64_t drives) const {
  Localised result;
  double squares = 0.0;
  int steps = 0;
  for (std::uint64_t seed = 1; seed <= drives; ++seed) {
    const std::vector<double> errors = errors_of_drive(plan, world_from_plan, seed);
    if (errors.empty()) continue;
    ++result.converged;
    for (std::size_t i = 3 * errors.size() / 4; i < errors.size(); ++i) {
      squares += errors[i] * errors[i];
      ++steps;
    }
  }
  result.rms = std::sqrt(squares / std::max(1, steps));
  return result;
}

std::vector<double> LaserRobotInTheOffice::errors_of_drive(const OccupancyPlan& plan,
                                                           const Pose2& world_from_plan,
                                                           std::uint64_t seed) const {
  LaserRobotOptions robot;
  robot.height = 0.15;
  robot.seed = seed;
  robot.start = 8.0 * static_cast<double>(seed);
  MonteCarloLocaliser localiser(plan, {}, seed);
  std::vector<double> errors;
  Pose2 before;
  double turned = 0.0;
  for (const LaserStep& step : drive(robot)) {
    localiser.update(before.inverse() * step.odometry_from_robot, step.ranges);
    before = step.odometry_from_robot;
    const Pose2 found = world_from_plan * localiser.map_from_robot();
    const Pose2& truth = step.world_from_robot;
    errors.push_back(std::hypot(found.x - truth.x, found.y - truth.y));
    turned = std::abs(std::remainder(found.yaw - truth.yaw, 2.0 * std::numbers::pi));
  }
  const bool converged = errors.back() < 0.2 && turned < 10.0 * std::numbers::pi / 180.0;
  return converged ? errors : std::vector<double>{};
}

}  // namespace kissmap
