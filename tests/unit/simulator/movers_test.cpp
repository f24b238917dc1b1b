// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include <algorithm>

#include "kissmap/error.hpp"
#include "simulator/scenario.hpp"

namespace kissmap::simulator {
namespace {

using Eigen::Vector3d;

Scenario scenario(const char* world, const char* motion, std::optional<int> movers) {
  Scenario result{world, "spinning16", motion, 4, 0, 90, 1.0};
  result.movers = movers;
  return result;
}

int cars(const World& world) {
  return static_cast<int>(std::ranges::count_if(world.moving, [](const MovingObject& object) {
    return object.parts.front().object_class == ObjectClass::moving_car;
  }));
}

bool same_solids(const World& a, const World& b) {
  return std::ranges::equal(a.primitives, b.primitives, [](const Primitive& p, const Primitive& q) {
    return p.world_from_object.translation == q.world_from_object.translation &&
           p.half_extents == q.half_extents;
  });
}

class Movers : public testing::TestWithParam<const char*> {
 protected:
  static World world(std::optional<int> movers) {
    return make_simulator(scenario(GetParam(), "robot", movers)).caster().world();
  }
};

TEST_P(Movers, AreAsManyAsAskedAmongTheSameThings) {
  const World usual = world({});
  EXPECT_GT(usual.moving.size(), 0U);
  for (const int n : {0, 1, 7, 40, 300}) {
    const World crowded = world(n);
    EXPECT_EQ(crowded.moving.size(), static_cast<std::size_t>(n));
    EXPECT_TRUE(same_solids(usual, crowded));
  }
}

// Longest stay within 20 cm of any place, over one period; long stays would look static.
TEST_P(Movers, NeverStandForAMinute) {
  for (const MovingObject& object : world(60).moving) {
    const Shuttle& shuttle = object.shuttle;
    for (double start = 0.0; start < shuttle.period; start += shuttle.period / 50) {
      double stay = 0.0;
      while (stay < 60.0 && (shuttle.offset(start + stay) - shuttle.offset(start)).norm() < 0.2) {
        stay += 0.25;
      }
      ASSERT_LT(stay, 15.0) << "period " << shuttle.period;
    }
  }
}

TEST_P(Movers, WalkThroughNothing) {
  const World crowded = world(60);
  for (const MovingObject& object : crowded.moving) {
    const Primitive& body = object.parts.front();
    const bool person = body.object_class == ObjectClass::pedestrian;
    for (double part = 0.0; part <= 1.0; part += 0.02) {
      const Vector3d middle = body.world_from_object.translation + part * object.shuttle.travel;
      for (const Primitive& solid : crowded.primitives) {
        ASSERT_GT(signed_distance(solid, middle), person ? body.half_extents.x() - 1e-9 : 0.2)
            << name(solid.object_class);
      }
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Worlds, Movers, testing::Values("town", "office"), [](const auto& tested) {
  return std::string(tested.param);
});

TEST(MoversInTown, AreCarsForAFifth) {
  EXPECT_EQ(cars(make_simulator(scenario("town", "car", 50)).caster().world()), 10);
}

TEST(MoversElsewhere, AreRefused) {
  EXPECT_THROW(make_simulator(scenario("garage", "car", 5)), Error);
  EXPECT_THROW(make_simulator(scenario("hill", "car", 5)), Error);
  EXPECT_THROW(make_simulator(scenario("town", "car", -1)), Error);
  EXPECT_THROW(make_simulator(scenario("hill", "robot", {})), Error);
  EXPECT_THROW(make_simulator(scenario("garage", "handheld", {})), Error);
}

}  // namespace
}  // namespace kissmap::simulator
