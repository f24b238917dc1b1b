// SPDX-License-Identifier: MIT
#include "simulator/route.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace kissmap::simulator {
namespace {

using Eigen::Vector3d;
constexpr double degree = std::numbers::pi / 180.0;

double length_of(const std::vector<PoseVector>& poses) {
  double length = 0.0;
  for (std::size_t i = 1; i < poses.size(); ++i) {
    length += (poses[i] - poses[i - 1]).head<3>().norm();
  }
  return length;
}

TEST(Drive, StartsAndEndsAtRestAtTheEnds) {
  const DrivingStyle style;
  const std::vector<PoseVector> poses = drive({{0, 0, 0}, {60, 0, 0}, {60, 40, 0}}, style);
  EXPECT_LT((poses.front().head<3>() - Vector3d(0, 0, 0)).norm(), 1e-9);
  EXPECT_LT((poses.back().head<3>() - Vector3d(60, 40, 0)).norm(), 0.11);
  EXPECT_LT((poses[1] - poses[0]).head<3>().norm() / style.interval, 0.5);
  EXPECT_NEAR(poses.front()[5], 0.0, 1e-9);
  EXPECT_NEAR(poses.back()[5], 90 * degree, 1e-3);
}

TEST(Drive, CutsCornersByArcsOfTheGivenRadius) {
  DrivingStyle style;
  style.corner_smoothing = 0.0;
  const std::vector<PoseVector> poses = drive({{0, 0, 0}, {60, 0, 0}, {60, 40, 0}}, style);
  const double saved = (2.0 - 0.5 * std::numbers::pi) * style.corner_radius;
  EXPECT_NEAR(length_of(poses), 100.0 - saved, 0.2);
  const Vector3d centre(60 - style.corner_radius, style.corner_radius, 0);
  for (const PoseVector& pose : poses) {
    const bool in_corner = pose[5] > 5 * degree && pose[5] < 85 * degree;
    if (!in_corner) continue;
    EXPECT_NEAR((pose.head<3>() - centre).norm(), style.corner_radius, 0.02);
  }
}

TEST(Drive, KeepsItsLimits) {
  DrivingStyle style;
  style.interval = 0.05;
  const std::vector<PoseVector> poses =
      drive({{0, 0, 0}, {80, 0, 0}, {80, 60, 0}, {20, 60, 0}, {20, 200, 0}}, style);
  double last_speed = 0.0;
  double fastest = 0.0;
  for (std::size_t i = 1; i < poses.size(); ++i) {
    const double speed = (poses[i] - poses[i - 1]).head<3>().norm() / style.interval;
    const double yaw_rate = (poses[i] - poses[i - 1])[5] / style.interval;
    fastest = std::max(fastest, speed);
    EXPECT_LT(std::abs(yaw_rate) * speed, 1.1 * style.lateral_acceleration);
    EXPECT_LT(std::abs(yaw_rate), 1.05 * style.turn_rate);
    EXPECT_GT(speed - last_speed, -(style.braking + 0.6) * style.interval);
    const bool moving = i > 5;  // the first steps start from a standstill within one sample
    EXPECT_TRUE(!moving || speed - last_speed < (style.acceleration + 0.6) * style.interval);
    last_speed = speed;
  }
  EXPECT_NEAR(fastest, style.max_speed, 0.05);
}

TEST(Drive, ClimbsRampsNoseUp) {
  DrivingStyle style;
  const double rise = 30.0 * std::tan(10 * degree);
  const std::vector<PoseVector> poses =
      drive({{0, 0, 0}, {20, 0, 0}, {50, 0, rise}, {80, 0, rise}}, style);
  double steepest = 0.0;
  for (const PoseVector& pose : poses) {
    steepest = std::min(steepest, pose[4]);
    if (pose[0] < 28.0 || pose[0] > 42.0) continue;
    EXPECT_NEAR(pose[4], -10 * degree, 1e-3);
    EXPECT_NEAR(pose[2], (pose[0] - 20.0) * std::tan(10 * degree), 1e-3);
  }
  EXPECT_GT(steepest, -10.1 * degree);
  EXPECT_NEAR(poses.back()[2], rise, 1e-6);
}

TEST(DriveWithTurnsInPlace, TurnsWhereItStands) {
  DrivingStyle style;
  style.max_speed = 1.0;
  style.turn_rate = 50 * degree;
  const std::vector<PoseVector> poses =
      drive_with_turns_in_place({{0, 0, 0}, {5, 0, 0}, {5, 5, 0}, {0, 5, 0}, {0, 0, 0}}, style);
  double turned = 0.0;
  for (std::size_t i = 1; i < poses.size(); ++i) {
    const PoseVector step = poses[i] - poses[i - 1];
    turned += step[5];
    EXPECT_LE(std::abs(step[5]), style.turn_rate * style.interval);
    EXPECT_TRUE(std::abs(step[5]) < 1e-6 || step.head<3>().norm() < 0.02);
  }
  EXPECT_NEAR(turned, 270 * degree, 1e-9) << "unwrapped";
}

}  // namespace
}  // namespace kissmap::simulator
