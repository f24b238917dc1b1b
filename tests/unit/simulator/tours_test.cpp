// SPDX-License-Identifier: MIT
#include "simulator/tours.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>

#include "simulator/ray_caster.hpp"
#include "support/matchers.hpp"

namespace kissmap::simulator {
namespace {

constexpr double degree = std::numbers::pi / 180.0;

struct Tour {
  const char* name;
  World (*world)(std::uint64_t seed);
  Motion (*motion)(std::uint64_t seed);
  double max_speed;      // m/s
  double max_rate;       // rad/s, about any axis
  double min_clearance;  // m, around the LiDAR
};

World town_world(std::uint64_t seed) {
  return make_town(seed).world;
}
World garage_world(std::uint64_t seed) {
  return make_garage(seed).world;
}
World hill_world(std::uint64_t seed) {
  return make_hill(seed).world;
}
World office_world(std::uint64_t seed) {
  return make_office(seed).world;
}

const Tour tours[] = {
    {"car",
     town_world,
     [](std::uint64_t s) { return town_car_tour(make_town(s), s); },  //
     10.5,
     0.85,
     1.2},
    {"car_opposite",
     town_world,
     [](std::uint64_t s) { return town_car_tour(make_town(s), s, Revisit::opposite_direction); },
     10.5,
     0.85,
     1.2},
    {"garage_car",
     garage_world,
     [](std::uint64_t s) { return garage_car_tour(make_garage(s), s); },
     4.8,  // 4 m/s, and the LiDAR swings forward where a ramp begins
     0.85,
     0.8},
    {"hill_car",
     hill_world,
     [](std::uint64_t s) { return hill_car_tour(make_hill(s), s); },
     10.5,
     0.85,
     1.2},
    {"town_walk",
     town_world,
     [](std::uint64_t s) { return town_walk(make_town(s), s); },  //
     2.0,
     135 * degree,
     0.4},
    {"town_robot",
     town_world,
     [](std::uint64_t s) { return town_robot_tour(make_town(s), s); },
     1.3,
     60 * degree,
     0.4},
    {"office_robot",
     office_world,
     [](std::uint64_t s) { return office_robot_tour(make_office(s), s); },
     1.0,
     60 * degree,
     0.3},
    {"office_walk",
     office_world,
     [](std::uint64_t s) { return office_walk(make_office(s), s); },
     2.0,
     135 * degree,
     0.3},
};

void PrintTo(const Tour& tour, std::ostream* os) {
  *os << tour.name;
}

class AnyTour : public testing::TestWithParam<Tour> {};

TEST_P(AnyTour, MovesSmoothlyWithinItsLimits) {
  const Motion motion = GetParam().motion(4);
  constexpr double dt = 0.01;
  double fastest = 0.0;
  double quickest = 0.0;
  Twist last = Twist::Zero();
  for (double t = 0.0; t < motion.duration(); t += dt) {
    const Twist velocity =
        log(motion.world_from_lidar(t).inverse() * motion.world_from_lidar(t + dt)) / dt;
    fastest = std::max(fastest, velocity.head<3>().norm());
    quickest = std::max(quickest, velocity.tail<3>().norm());
    // No kink: velocities change by accelerations a body can have (20 m/s^2, 20 rad/s^2).
    if (t > 0.0) {
      ASSERT_LT((velocity - last).lpNorm<Eigen::Infinity>() / dt, 20.0) << "at " << t;
    }
    last = velocity;
  }
  EXPECT_LT(fastest, GetParam().max_speed);
  EXPECT_GT(fastest, 0.6 * GetParam().max_speed);
  EXPECT_LT(quickest, GetParam().max_rate);
  EXPECT_GT(quickest, 0.4 * GetParam().max_rate);
}

TEST_P(AnyTour, HalvingTheStepHalvesTheMotion) {
  const Motion motion = GetParam().motion(5);
  for (double t = 1.0; t < motion.duration() - 1.0; t += 3.17) {
    const Rigid3 here_from_there =
        motion.world_from_lidar(t).inverse() * motion.world_from_lidar(t + 2e-3);
    const Rigid3 here_from_middle =
        motion.world_from_lidar(t).inverse() * motion.world_from_lidar(t + 1e-3);
    EXPECT_THAT(exp(0.5 * log(here_from_there)), PoseNear(here_from_middle, 2e-5, 2e-5))
        << "at " << t;
  }
}

TEST_P(AnyTour, StaysClearOfEverything) {
  for (const std::uint64_t seed : {1, 2, 3}) {
    const RayCaster caster(GetParam().world(seed));
    const Motion motion = GetParam().motion(seed);
    double clearance = 1e9;
    double when = 0.0;
    for (double t = 0.0; t < motion.duration(); t += 0.2) {
      const double here = caster.distance(motion.world_from_lidar(t).translation, t);
      if (here < clearance) when = t;
      clearance = std::min(clearance, here);
    }
    EXPECT_GT(clearance, GetParam().min_clearance) << "seed " << seed << " at " << when << " s";
  }
}

INSTANTIATE_TEST_SUITE_P(Tours, AnyTour, testing::ValuesIn(tours), [](const auto& tested) {
  return std::string(tested.param.name);
});

// Metres travelled during which the LiDAR is within `near` metres of where it was more than 30 s
// before, heading the same way (cosine of the headings above 0.7) or the opposite way.
double revisited(const Motion& motion, double near, bool same_heading) {
  double metres = 0.0;
  for (double t = 30.0; t + 0.5 < motion.duration(); t += 0.5) {
    const Rigid3 now = motion.world_from_lidar(t);
    bool met = false;
    for (double before = 0.0; before < t - 30.0 && !met; before += 0.5) {
      const Rigid3 then = motion.world_from_lidar(before);
      const double cosine =
          (then.rotation * Eigen::Vector3d::UnitX()).dot(now.rotation * Eigen::Vector3d::UnitX());
      met = (then.translation - now.translation).norm() < near &&
            (same_heading ? cosine : -cosine) > 0.7;
    }
    if (met) metres += (motion.world_from_lidar(t + 0.5).translation - now.translation).norm();
  }
  return metres;
}

TEST(Tours, TheCarDrivesItsLoopAgainInTheSameDirection) {
  const Motion motion = town_car_tour(make_town(1), 1);
  EXPECT_GT(revisited(motion, 5.0, true), 180.0);
  EXPECT_EQ(revisited(motion, 5.0, false), 0.0);
}

TEST(Tours, TheOtherCarTourMeetsItsWayInTheOppositeDirection) {
  const Motion motion = town_car_tour(make_town(1), 1, Revisit::opposite_direction);
  EXPECT_GT(revisited(motion, 5.0, false), 180.0);
  EXPECT_LT(revisited(motion, 5.0, true), 20.0);
}

TEST(Tours, WalksAndRobotsComeBackToo) {
  EXPECT_GT(revisited(town_walk(make_town(1), 1), 1.5, true), 20.0);
  EXPECT_GT(revisited(office_robot_tour(make_office(1), 1), 0.5, true), 8.0);
  EXPECT_GT(revisited(office_walk(make_office(1), 1), 0.5, true), 5.0);
}

double quickest_turn(const Motion& motion) {
  double quickest = 0.0;
  for (double t = 0.0; t < motion.duration(); t += 0.02) {
    const Rigid3 step = motion.world_from_lidar(t).inverse() * motion.world_from_lidar(t + 0.02);
    quickest = std::max(quickest, step.angle() / 0.02);
  }
  return quickest;
}

TEST(Tours, WalksAreAsLivelyAsAsked) {
  const Town town = make_town(1);
  const double calm = quickest_turn(town_walk(town, 1, 0.0));
  const double half = quickest_turn(town_walk(town, 1, 0.5));
  const double lively = quickest_turn(town_walk(town, 1, 1.0));
  EXPECT_LT(calm, 45 * degree) << "only corners turn";
  EXPECT_LT(half, lively);
  EXPECT_GT(lively, 90 * degree);
}

TEST(Tours, DependOnTheSeed) {
  const Town town = make_town(1);
  const Rigid3 a = town_walk(town, 1).world_from_lidar(20.0);
  EXPECT_THAT(town_walk(town, 1).world_from_lidar(20.0), PoseNear(a, 0.0, 0.0));
  EXPECT_GT((town_walk(town, 2).world_from_lidar(20.0).inverse() * a).angle(), 0.01);
}

}  // namespace
}  // namespace kissmap::simulator
