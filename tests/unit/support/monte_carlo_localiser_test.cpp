// SPDX-License-Identifier: MIT
#include "support/monte_carlo_localiser.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "kissmap/error.hpp"
#include "simulator/tours.hpp"
#include "support/distance_field.hpp"
#include "support/laser_robot.hpp"

namespace kissmap {
namespace {

constexpr double degree = std::numbers::pi / 180.0;

struct Storey {
  simulator::Office office = simulator::make_office(1);
  simulator::RayCaster caster{office.world};
  simulator::Motion motion = simulator::office_robot_tour(office, 1);
  LaserRobotOptions robot;

  // The exact floor plan at the height of the laser.
  OccupancyPlan plan() const {
    const simulator::PlanFrame frame{{-1.0, -1.0}, 0.05, 840, 540};
    const simulator::FloorBand band{robot.height - 0.02, robot.height + 0.02};
    const Eigen::AlignedBox2d inside(Eigen::Vector2d::Zero(),
                                     Eigen::Vector2d(office.options.length, office.options.width));
    return exact_plan(solids_in_band(office.world, frame, band),
                      [&](const Eigen::Vector2d& p) { return inside.contains(p); });
  }
};

// Drives 60 m from a place on the tour that depends on the seed.
bool finds_itself(const Storey& storey, const OccupancyPlan& plan, std::uint64_t seed) {
  LaserRobotOptions robot = storey.robot;
  robot.seed = seed;
  robot.start = 8.0 * static_cast<double>(seed);
  const auto steps = drive_laser_robot(storey.caster, storey.motion, robot);
  LocaliserOptions options;
  options.max_range = robot.max_range;
  MonteCarloLocaliser localiser(plan, options, seed);
  Pose2 before;
  for (const LaserStep& step : steps) {
    localiser.update(before.inverse() * step.odometry_from_robot, step.ranges);
    before = step.odometry_from_robot;
  }
  const Pose2 found = localiser.map_from_robot();
  const Pose2& truth = steps.back().world_from_robot;
  const double away = std::hypot(found.x - truth.x, found.y - truth.y);
  const double turned = std::abs(std::remainder(found.yaw - truth.yaw, 2.0 * std::numbers::pi));
  return away < 0.2 && turned < 10.0 * degree;
}

int successes_of_ten(const OccupancyPlan& plan) {
  const Storey storey;
  int found = 0;
  for (std::uint64_t seed = 1; seed <= 10; ++seed)
    found += finds_itself(storey, plan, seed) ? 1 : 0;
  return found;
}

TEST(MonteCarloLocaliser, FindsItselfOnTheExactFloorPlan) {
  EXPECT_GE(successes_of_ten(Storey().plan()), 9);
}

// The commonest mistake of map writers: rows stored the wrong way round.
TEST(MonteCarloLocaliser, IsLostOnAFlippedPlan) {
  OccupancyPlan plan = Storey().plan();
  for (int row = 0; row < plan.height / 2; ++row) {
    for (int column = 0; column < plan.width; ++column) {
      std::swap(plan.cells[plan.index(column, row)],
                plan.cells[plan.index(column, plan.height - 1 - row)]);
    }
  }
  EXPECT_EQ(successes_of_ten(plan), 0);
}

TEST(MonteCarloLocaliser, IsElsewhereOnAShiftedPlan) {
  OccupancyPlan plan = Storey().plan();
  plan.origin.x() += 1.0;
  EXPECT_EQ(successes_of_ten(plan), 0);
}

TEST(MonteCarloLocaliser, GivesTheSameAnswerForTheSameSeed) {
  const Storey storey;
  const OccupancyPlan plan = storey.plan();
  LaserRobotOptions robot = storey.robot;
  robot.distance = 2.0;
  const auto steps = drive_laser_robot(storey.caster, storey.motion, robot);
  const auto answer = [&](std::uint64_t seed) {
    MonteCarloLocaliser localiser(plan, {}, seed);
    Pose2 before;
    for (const LaserStep& step : steps) {
      localiser.update(before.inverse() * step.odometry_from_robot, step.ranges);
      before = step.odometry_from_robot;
    }
    return localiser.map_from_robot();
  };
  const Pose2 first = answer(1);
  const Pose2 again = answer(1);
  EXPECT_EQ(first.x, again.x);
  EXPECT_EQ(first.y, again.y);
  EXPECT_EQ(first.yaw, again.yaw);
  EXPECT_NE(first.x, answer(2).x);
}

TEST(DistanceField, IsThatOfBruteForce) {
  simulator::Random random{5};
  for (int trial = 0; trial < 20; ++trial) {
    OccupancyPlan plan;
    plan.width = 1 + static_cast<int>(random.uniform(0.0, 30.0));
    plan.height = 1 + static_cast<int>(random.uniform(0.0, 20.0));
    plan.resolution = 0.1;
    const double share = trial % 2 == 0 ? 0.02 : 0.3;
    for (int i = 0; i < plan.width * plan.height; ++i) {
      plan.cells.push_back(random.chance(share) ? PlanCell::occupied
                           : random.chance(0.5) ? PlanCell::free
                                                : PlanCell::unknown);
    }
    plan.cells[plan.cells.size() / 2] = PlanCell::occupied;
    const std::vector<double> field = distances_to_occupied(plan);
    for (int row = 0; row < plan.height; ++row) {
      for (int column = 0; column < plan.width; ++column) {
        double nearest = 1e9;
        for (int r = 0; r < plan.height; ++r) {
          for (int c = 0; c < plan.width; ++c) {
            if (plan.cells[plan.index(c, r)] != PlanCell::occupied) continue;
            nearest = std::min(nearest, 0.1 * std::hypot(c - column, r - row));
          }
        }
        ASSERT_NEAR(field[plan.index(column, row)], nearest, 1e-9);
      }
    }
  }
}

TEST(MonteCarloLocaliser, RefusesMapsWithoutRoomOrWalls) {
  OccupancyPlan plan;
  plan.width = plan.height = 2;
  plan.cells.assign(4, PlanCell::free);
  EXPECT_THROW(MonteCarloLocaliser(plan, {}, 1), Error);
  plan.cells.assign(4, PlanCell::occupied);
  EXPECT_THROW(MonteCarloLocaliser(plan, {}, 1), Error);
}

// In a rectangular room of known size, the ranges ahead and aside are known; wheels slip as said.
TEST(LaserRobot, MeasuresRangesAndSlipsAsStated) {
  simulator::World world;
  for (const double side : {-1.0, 1.0}) {
    world.primitives.push_back(simulator::make_box(
        simulator::ObjectClass::wall, {}, {-21, side * 3.0, 0}, {21, side * 4.0, 2}));
  }
  world.primitives.push_back(
      simulator::make_box(simulator::ObjectClass::wall, {}, {20, -4, 0}, {21, 4, 2}));
  const simulator::RayCaster caster(std::move(world));
  simulator::Motion motion;
  for (int i = 0; i <= 300; ++i) {
    simulator::PoseVector pose = simulator::PoseVector::Zero();
    pose[0] = -15.0 + 0.1 * i;
    motion.control.push_back(pose);
  }
  LaserRobotOptions options;
  options.range_noise = 0.0;
  double squares = 0.0;
  int runs = 0;
  for (std::uint64_t seed = 1; seed <= 200; ++seed) {
    options.seed = seed;
    options.distance = 10.0;
    const auto steps = drive_laser_robot(caster, motion, options);
    const LaserStep& last = steps.back();
    EXPECT_NEAR(last.ranges[90], 3.0F, 1e-5F) << "to the right";
    EXPECT_NEAR(last.ranges[270], 3.0F, 1e-5F) << "to the left";
    const double ahead = 20.0 - last.world_from_robot.x;
    EXPECT_NEAR(last.ranges[180], ahead < options.max_range ? ahead : 0.0, 1e-5);
    EXPECT_EQ(last.ranges[0], 0.0F) << "nothing behind";
    squares += last.odometry_from_robot.yaw * last.odometry_from_robot.yaw;
    ++runs;
  }
  // 50 steps of 0.2 m, each 0.01 rad per metre.
  const double expected = 0.01 * 0.2 * std::sqrt(50.0);
  EXPECT_NEAR(std::sqrt(squares / runs), expected, 4.0 * expected / std::sqrt(2.0 * runs));
}

}  // namespace
}  // namespace kissmap
