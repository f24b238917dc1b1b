// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "kissmap/error.hpp"
#include "simulator/plan_truth.hpp"
#include "simulator/random.hpp"
#include "simulator/ray_caster.hpp"
#include "simulator/tours.hpp"

namespace kissmap::simulator {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;
constexpr double degree = std::numbers::pi / 180.0;

double steepest(const World& world) {
  double slope = 0.0;
  for (const FloorPiece& piece : world.floors) slope = std::max(slope, piece.slope.norm());
  return std::atan(slope);
}

TEST(Garage, RampsAreOfTenDegreesAndJoinTheLevels) {
  const Garage garage = make_garage(1);
  EXPECT_NEAR(steepest(garage.world), 10.0 * degree, 1e-12);
  int ramps = 0;
  for (const FloorPiece& piece : garage.world.floors) {
    if (piece.slope.isZero()) continue;
    ++ramps;
    EXPECT_TRUE(piece.on_level(0) && piece.on_level(1));
    const double y = piece.area.center().y();
    const double west = piece.height_at({piece.area.min().x(), y});
    const double east = piece.height_at({piece.area.max().x(), y});
    EXPECT_NEAR(std::min(west, east), 0.0, 1e-9);
    EXPECT_NEAR(std::max(west, east), garage.options.storey, 1e-9);
    for (const int level : {0, 1}) {
      const bool west_end = (level == 0) == (west < east);
      const double beyond = west_end ? piece.area.min().x() - 0.1 : piece.area.max().x() + 0.1;
      const auto next = floor_height(garage.world, beyond, y, level);
      ASSERT_TRUE(next);
      EXPECT_NEAR(*next, west_end ? west : east, 1e-9) << "the floor goes on without a step";
    }
  }
  EXPECT_EQ(ramps, 2);
}

TEST(Hill, IsSteepButNotTooSteepAndWithoutGaps) {
  const Hill hill = make_hill(1);
  EXPECT_GT(steepest(hill.world), 7.5 * degree);
  EXPECT_LE(steepest(hill.world), 8.0 * degree);
  Random random{3};
  double highest = 0.0;
  for (int i = 0; i < 2000; ++i) {
    const Vector2d p{random.uniform(-59.0, 179.0), random.uniform(-59.0, 139.0)};
    const auto here = floor_height(hill.world, p.x(), p.y());
    const auto near = floor_height(hill.world, p.x() + 1e-3, p.y() + 1e-3);
    ASSERT_TRUE(here && near);
    highest = std::max(highest, *here);
    const double step = std::abs(*here - *near);
    EXPECT_TRUE(step < 3e-4 || std::abs(step - 0.12) < 3e-4)
        << "neither level nor a kerb: " << step;
  }
  EXPECT_GT(highest, 6.0);
}

// The kerb along every street is as high as it should be, up and down the slopes.
TEST(Hill, KerbsFollowTheRoad) {
  const Hill hill = make_hill(2);
  for (double x = 6.0; x < 114.0; x += 0.7) {
    for (const auto& [road, side] : {std::pair(5.1, 5.3), std::pair(-5.1, -5.3)}) {
      EXPECT_NEAR(
          *floor_height(hill.world, x, side) - *floor_height(hill.world, x, road), 0.12, 1e-9);
    }
  }
}

struct Place {
  const char* name;
  World (*world)(std::uint64_t seed);
  Motion (*motion)(std::uint64_t seed);
  int levels;
};

const Place places[] = {{"garage",
                         [](std::uint64_t s) { return make_garage(s).world; },
                         [](std::uint64_t s) { return garage_car_tour(make_garage(s), s); },
                         2},
                        {"hill",
                         [](std::uint64_t s) { return make_hill(s).world; },
                         [](std::uint64_t s) { return hill_car_tour(make_hill(s), s); },
                         1}};

void PrintTo(const Place& place, std::ostream* os) {
  *os << place.name;
}

class SlopedPlace : public testing::TestWithParam<Place> {};

// The truth of the floors and the ray caster share no code: a ray straight down from head height
// above the floor of a level ends on it, unless something stands there.
TEST_P(SlopedPlace, FloorsAreWhereRaysFromAboveEnd) {
  const RayCaster caster(GetParam().world(3));
  Random random{8};
  for (int level = 0; level < GetParam().levels; ++level) {
    int seen = 0;
    int blocked = 0;
    for (int i = 0; i < 3000; ++i) {
      const double x = random.uniform(-59.0, 139.0);
      const double y = random.uniform(-59.0, 139.0);
      const auto floor = floor_height(caster.world(), x, y, level);
      if (!floor) continue;
      const auto hit = caster.cast({x, y, *floor + 2.2}, -Vector3d::UnitZ(), 0.0, 5.0);
      const bool on_floor = hit && (hit->primitive->object_class == ObjectClass::floor ||
                                    hit->primitive->object_class == ObjectClass::ground ||
                                    hit->primitive->object_class == ObjectClass::sidewalk);
      (on_floor ? seen : blocked) += 1;
      if (on_floor) {
        ASSERT_NEAR(hit->range, 2.2, 1e-9) << x << ' ' << y << " level " << level;
      } else {
        // From inside a house, the ray meets the ground below it; else something stands there.
        ASSERT_TRUE(hit);
        ASSERT_LT(hit->range, 2.2);
      }
    }
    EXPECT_GT(seen, 100);
    EXPECT_LT(blocked, seen);
  }
}

TEST_P(SlopedPlace, AnswersLikeBruteForce) {
  const RayCaster caster(GetParam().world(4));
  Random random{9};
  int hits = 0;
  for (int i = 0; i < 6000; ++i) {
    const Vector3d origin{
        random.uniform(-20.0, 130.0), random.uniform(-20.0, 90.0), random.uniform(0.2, 9.0)};
    const Vector3d direction =
        Vector3d{random.normal(), random.normal(), 0.3 * random.normal()}.normalized();
    const auto hit = caster.cast(origin, direction, 0.0, 80.0);
    const auto expected = caster.cast_by_brute_force(origin, direction, 0.0, 80.0);
    ASSERT_EQ(hit.has_value(), expected.has_value());
    if (!hit) continue;
    ++hits;
    EXPECT_EQ(hit->range, expected->range);
    EXPECT_EQ(hit->primitive, expected->primitive);
  }
  EXPECT_GT(hits, 500);
}

TEST_P(SlopedPlace, TheCarStaysOnTheFloorAndVisitsEveryLevel) {
  const World world = GetParam().world(5);
  const Motion motion = GetParam().motion(5);
  std::vector<double> on_level(static_cast<std::size_t>(GetParam().levels), 0.0);
  int level = 0;
  double steepest_pitch = 0.0;
  for (double t = 0.0; t < motion.duration(); t += 0.1) {
    const Rigid3 pose = motion.world_from_lidar(t);
    const auto above = [&](int which) {
      const auto floor = floor_height(world, pose.translation.x(), pose.translation.y(), which);
      return floor ? pose.translation.z() - *floor : 1e9;
    };
    for (int other = 0; other < GetParam().levels; ++other) {
      if (std::abs(above(other) - 1.9) < std::abs(above(level) - 1.9)) level = other;
    }
    // Suspension, and the kinks at the ends of ramps, which wheels round off.
    ASSERT_NEAR(above(level), 1.9, 0.15) << "at " << t << " s";
    on_level[static_cast<std::size_t>(level)] += 0.1;
    steepest_pitch =
        std::max(steepest_pitch, std::abs(std::asin((pose.rotation * Vector3d::UnitX()).z())));
  }
  for (const double seconds : on_level) EXPECT_GT(seconds, 25.0);
  EXPECT_GT(steepest_pitch, 6.5 * degree);
}

// On the level on which it is, nothing in the band fills the way of the car; on a ramp, that is
// one of the two. Walls and cars do fill what is beside it.
TEST_P(SlopedPlace, TheBandAboveTheWayIsFree) {
  const World world = GetParam().world(6);
  const Motion motion = GetParam().motion(6);
  const PlanFrame frame{{-10, -10}, 0.2, 750, 550};
  std::vector<PlanTruth> truths;
  for (int level = 0; level < GetParam().levels; ++level) {
    truths.push_back(solids_in_band(world, frame, {0.15, 1.5, level}));
    EXPECT_GT(std::ranges::count_if(truths.back().classes, [](auto bits) { return bits != 0; }),
              1000);
  }
  for (double t = 0.0; t < motion.duration(); t += 0.1) {
    const Vector3d p = motion.world_from_lidar(t).translation;
    const Vector2d cell = (p.head<2>() - frame.lower_left) / frame.resolution;
    bool free = false;
    for (int level = 0; level < GetParam().levels; ++level) {
      const auto floor = floor_height(world, p.x(), p.y(), level);
      if (!floor || std::abs(p.z() - *floor - 1.9) > 0.2) continue;
      const PlanTruth& truth = truths[static_cast<std::size_t>(level)];
      free = free || !truth.touched(static_cast<int>(cell.x()), static_cast<int>(cell.y()));
    }
    ASSERT_TRUE(free) << "at " << t << " s";
  }
}

TEST_P(SlopedPlace, PiecesOfALevelDoNotOverlap) {
  const World world = GetParam().world(7);
  for (int level = 0; level < GetParam().levels; ++level) {
    for (std::size_t i = 0; i < world.floors.size(); ++i) {
      for (std::size_t k = 0; k < i; ++k) {
        if (!world.floors[i].on_level(level) || !world.floors[k].on_level(level)) continue;
        const auto shared = world.floors[i].area.intersection(world.floors[k].area);
        EXPECT_TRUE(shared.isEmpty() || shared.sizes().minCoeff() < 1e-9);
      }
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Places, SlopedPlace, testing::ValuesIn(places), [](const auto& tested) {
  return std::string(tested.param.name);
});

TEST(Garage, RefusesALotTooSmallForItsRamps) {
  GarageOptions options;
  options.length = 45.0;
  EXPECT_THROW(make_garage(1, options), Error);
}

}  // namespace
}  // namespace kissmap::simulator
