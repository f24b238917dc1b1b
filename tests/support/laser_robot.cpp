// SPDX-License-Identifier: MIT
#include "support/laser_robot.hpp"

#include <cmath>
#include <numbers>

#include "simulator/random.hpp"

namespace kissmap {
namespace {

using simulator::Random;
constexpr double pi = std::numbers::pi;
constexpr std::uint64_t laser_stream = 0x4C415345;
constexpr std::uint64_t wheel_stream = 0x57484545;

Pose2 seen_from_above(const Rigid3& pose) {
  const Eigen::Vector3d ahead = pose.rotation * Eigen::Vector3d::UnitX();
  return {pose.translation.x(), pose.translation.y(), std::atan2(ahead.y(), ahead.x())};
}

std::vector<float> scan(const simulator::RayCaster& caster,
                        const Pose2& pose,
                        double time,
                        const LaserRobotOptions& options,
                        Random& random) {
  std::vector<float> ranges;
  for (int k = 0; k < options.beams; ++k) {
    const double angle = pose.yaw - pi + 2.0 * pi * k / options.beams;
    const auto hit = caster.cast({pose.x, pose.y, options.height},
                                 {std::cos(angle), std::sin(angle), 0.0},
                                 time,
                                 options.max_range);
    const double noise = options.range_noise * random.normal();
    ranges.push_back(hit ? static_cast<float>(std::max(0.0, hit->range + noise)) : 0.0F);
  }
  return ranges;
}

Pose2 slipped(const Pose2& step, const LaserRobotOptions& options, Random& random) {
  const double distance = std::hypot(step.x, step.y);
  const double scale = 1.0 + options.slip_distance * random.normal();
  const double turn = step.yaw * (1.0 + options.slip_turn * random.normal()) +
                      options.slip_heading * distance * random.normal();
  return {scale * step.x, scale * step.y, turn};
}

}  // namespace

std::vector<LaserStep> drive_laser_robot(const simulator::RayCaster& caster,
                                         const simulator::Motion& motion,
                                         const LaserRobotOptions& options) {
  Random beams{options.seed, laser_stream};
  Random wheels{options.seed, wheel_stream};
  std::vector<LaserStep> steps;
  double driven = 0.0;
  for (double time = options.start; time < motion.duration() && driven < options.distance;
       time += 0.05) {
    const Pose2 truth = seen_from_above(motion.world_from_lidar(time));
    Pose2 odometry;
    if (!steps.empty()) {
      Pose2 step = steps.back().world_from_robot.inverse() * truth;
      step.yaw = std::remainder(step.yaw, 2.0 * pi);
      const double distance = std::hypot(step.x, step.y);
      if (distance < options.step && std::abs(step.yaw) < options.turn) continue;
      driven += distance;
      odometry = steps.back().odometry_from_robot * slipped(step, options, wheels);
    }
    steps.push_back({time, truth, odometry, scan(caster, truth, time, options, beams)});
  }
  return steps;
}

}  // namespace kissmap
