// SPDX-License-Identifier: MIT
#include "simulator/plan_truth.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "kissmap/error.hpp"
#include "simulator/office.hpp"
#include "simulator/random.hpp"
#include "simulator/scenario.hpp"
#include "simulator/town.hpp"

namespace kissmap::simulator {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

FloorPiece piece(const Vector2d& low, const Vector2d& high, double height, const Vector2d& slope) {
  FloorPiece result;
  result.area = {low, high};
  result.height = height;
  result.slope = slope;
  return result;
}

World on_level_floor(std::vector<Primitive> solids) {
  World world;
  world.primitives = std::move(solids);
  world.floors = {piece({-50, -50}, {50, 50}, 0.0, {0, 0})};
  return world;
}

int count(const PlanTruth& truth) {
  return static_cast<int>(
      std::ranges::count_if(truth.classes, [](auto bits) { return bits != 0; }));
}

TEST(PlanTruth, ABoxOnCellBordersTouchesItsCellsOnly) {
  const World world =
      on_level_floor({make_box(ObjectClass::wall, Rigid3{}, {0.1, 0.2, 0.0}, {0.4, 0.3, 2.0})});
  const PlanTruth truth = solids_in_band(world, {{0, 0}, 0.05, 20, 20}, {0.1, 1.0});
  for (int row = 0; row < 20; ++row) {
    for (int column = 0; column < 20; ++column) {
      const bool inside = column >= 2 && column < 8 && row >= 4 && row < 6;
      EXPECT_EQ(truth.touched(column, row, ObjectClass::wall), inside) << column << ' ' << row;
      EXPECT_FALSE(truth.touched(column, row, ObjectClass::door));
    }
  }
}

TEST(PlanTruth, TheSmallestOverlapCounts) {
  const World world =
      on_level_floor({make_box(ObjectClass::wall, Rigid3{}, {0.5 - 1e-6, 0.2, 0}, {0.6, 0.3, 1})});
  EXPECT_EQ(count(solids_in_band(world, {{0, 0}, 0.1, 10, 10}, {0.1, 1.0})), 2);
  EXPECT_EQ(count(solids_in_band(world, {{0, 0}, 0.1, 10, 10}, {1.0, 2.0})), 0) << "borders only";
  EXPECT_EQ(count(solids_in_band(world, {{0, 0}, 0.1, 10, 10}, {1.0 - 1e-6, 2.0})), 2);
}

// A square on its corner, a disc: areas in cells known by hand.
TEST(PlanTruth, ATurnedSquareAndADiscTouchWhatTheyShould) {
  const double half = std::sqrt(0.5);
  const World diamond = on_level_floor({make_box(ObjectClass::desk,
                                                 planar_frame({0, 0, 0}, std::numbers::pi / 4),
                                                 {-half, -half, 0},
                                                 {half, half, 1})});
  // |x| + |y| < 1 in cells of 0.5: the inner four and two more on either side of each tip.
  EXPECT_EQ(count(solids_in_band(diamond, {{-2, -2}, 0.5, 8, 8}, {0, 1})), 12);
  const World disc =
      on_level_floor({make_cylinder(ObjectClass::chair_leg, Rigid3{}, {0, 0, 0}, 0.6, 1.0)});
  // The corner (0.5, 0.5) is 0.707 away, (0.5, 0) only 0.5.
  EXPECT_EQ(count(solids_in_band(disc, {{-2, -2}, 0.5, 8, 8}, {0, 1})), 12);
}

TEST(PlanTruth, TheBandFollowsASlope) {
  World world;
  world.floors = {piece({0, 0}, {10, 1}, 0.0, {0.5, 0})};
  // A level beam, 2 m high: 1.0 to 1.5 m above a floor that reaches 1 m at x = 2.
  world.primitives = {make_box(ObjectClass::wall, Rigid3{}, {0, 0, 2.0}, {10, 1, 2.1})};
  const PlanTruth truth = solids_in_band(world, {{0, 0}, 0.1, 100, 10}, {1.0, 1.5});
  for (int column = 0; column < 100; ++column) {
    // Above the floor the beam spans 2 - x / 2 to 2.1 - x / 2.
    const bool inside = column >= 10 && column < 22;
    EXPECT_EQ(truth.touched(column, 5), inside) << column;
  }
}

Primitive random_solid(Random& random) {
  const auto where = [&] { return random.uniform(-1.5, 1.5); };
  const Vector3d middle{where(), where(), random.uniform(-0.5, 1.5)};
  const auto size = [&] { return random.uniform(0.02, 0.7); };
  const Vector3d half{size(), size(), size()};
  Rigid3 frame = planar_frame(middle, random.uniform(-3.0, 3.0));
  const double kind = random.uniform();
  if (kind < 0.3) {
    return make_cylinder(ObjectClass::pole, frame, {0, 0, -half.z()}, half.x(), 2.0 * half.z());
  }
  if (kind < 0.6) {
    frame.rotation = frame.rotation *
                     Eigen::AngleAxisd(random.uniform(-1.5, 1.5), Vector3d(1, 0.3, 0).normalized());
  }
  Primitive box = make_box(ObjectClass::wall, frame, -half, half);
  if (kind > 0.8) box.slope = {random.uniform(-1.0, 1.0), random.uniform(-1.0, 1.0)};
  return box;
}

// Points of a cell inside the band, on a lattice, tell how near the solid comes to it.
double nearest_sample(
    const World& world, const PlanFrame& frame, const FloorBand& band, int column, int row, int n) {
  double nearest = 1e9;
  for (int i = 0; i < n; ++i) {
    for (int j = 0; j < n; ++j) {
      const Vector2d place =
          frame.corner(column, row) + frame.resolution / (n - 1) * Vector2d(i, j);
      for (const FloorPiece& piece : world.floors) {
        if (!piece.area.contains(place)) continue;
        for (int k = 0; k < n; ++k) {
          const double z =
              piece.height_at(place) + band.z_min + (band.z_max - band.z_min) / (n - 1) * k;
          nearest = std::min(nearest,
                             signed_distance(world.primitives.front(), {place.x(), place.y(), z}));
        }
      }
    }
  }
  return nearest;
}

// Any sample inside the solid proves a touch; and a touched cell has a sample within half the
// lattice's diagonal of the solid, sheared as the band is.
TEST(PlanTruth, AgreesWithBruteForceOnSlopes) {
  Random random{11};
  constexpr int n = 13;
  const PlanFrame frame{{-2, -2}, 0.4, 10, 10};
  int touched = 0;
  int free = 0;
  for (int trial = 0; trial < 150; ++trial) {
    World world;
    const Vector2d slope{random.uniform(-0.5, 0.5), random.uniform(-0.5, 0.5)};
    const double cut = random.uniform(-1.0, 1.0);
    world.floors = {piece({-3, -3}, {cut, 3}, random.uniform(-0.2, 0.2), slope),
                    piece({cut, -3}, {3, 3}, random.uniform(-0.2, 0.2), {0, 0.1})};
    world.primitives = {random_solid(random)};
    const FloorBand band{0.1, 0.1 + random.uniform(0.05, 0.6)};
    const PlanTruth truth = solids_in_band(world, frame, band);
    const double flat = frame.resolution / (n - 1) * std::sqrt(0.5);
    const double steep = 0.5 * (band.z_max - band.z_min) / (n - 1) + slope.norm() * flat;
    for (int row = 0; row < frame.rows; ++row) {
      for (int column = 0; column < frame.columns; ++column) {
        const double nearest = nearest_sample(world, frame, band, column, row, n);
        const bool claimed = truth.touched(column, row);
        touched += claimed ? 1 : 0;
        free += claimed ? 0 : 1;
        if (claimed) {
          // Samples on both sides of the step between the pieces: twice the spacing.
          ASSERT_LE(nearest, 2.0 * std::hypot(flat, steep)) << trial << ' ' << column << ' ' << row;
        } else {
          ASSERT_GT(nearest, -1e-7) << trial << ' ' << column << ' ' << row;
        }
      }
    }
  }
  EXPECT_GT(touched, 500);
  EXPECT_GT(free, 500);
}

TEST(PlanTruth, AnOfficeHasWallsDoorsAndLegsWhereItsPlanSays) {
  const Office office = make_office(1);
  const PlanFrame frame{{-0.5, -0.5}, 0.02, 2050, 1300};
  const PlanTruth low = solids_in_band(office.world, frame, {0.2, 0.4});
  const auto at = [&](const Vector2d& p, ObjectClass what) {
    const Vector2d cell = (p - frame.lower_left) / frame.resolution;
    return low.touched(static_cast<int>(cell.x()), static_cast<int>(cell.y()), what);
  };
  int open = 0;
  int closed = 0;
  for (const PlanRoom& room : office.rooms) {
    EXPECT_EQ(at(room.door.middle, ObjectClass::door), !room.door.open);
    EXPECT_FALSE(at(room.door.middle, ObjectClass::wall));
    (room.door.open ? open : closed) += 1;
  }
  EXPECT_GT(open, 5);
  EXPECT_GT(closed, 1);
  double legs = 0.0;
  for (const Primitive& solid : office.world.primitives) {
    const bool chair = solid.object_class == ObjectClass::chair_leg;
    if (!chair && solid.object_class != ObjectClass::desk_leg) continue;
    EXPECT_GE(solid.half_extents.head<2>().minCoeff(), 0.01) << "legs are 2 cm thick or more";
    EXPECT_TRUE(at(solid.world_from_object.translation.head<2>(), solid.object_class));
    legs += 1.0;
  }
  EXPECT_GT(legs, 100.0);
  for (std::size_t i = 0; i < low.classes.size(); ++i) {
    ASSERT_EQ(low.classes[i] >> static_cast<unsigned>(ObjectClass::floor) & 1U, 0U);
    ASSERT_EQ(low.classes[i] >> static_cast<unsigned>(ObjectClass::chair_seat) & 1U, 0U);
  }
}

TEST(PlanTruth, RefusesWhatItCannotAnswer) {
  World world = on_level_floor({});
  const PlanFrame frame{{0, 0}, 0.1, 4, 4};
  EXPECT_THROW(solids_in_band(world, {{0, 0}, 0.0, 4, 4}, {}), Error);
  EXPECT_THROW(solids_in_band(world, frame, {1.0, 1.0}), Error);
  EXPECT_THROW(solids_in_band(world, frame, {0.1, 1.0, 1}), Error);
  Rigid3 fallen;
  fallen.rotation = Eigen::AngleAxisd(1.0, Vector3d::UnitX());
  world.primitives = {make_cylinder(ObjectClass::pole, fallen, {0, 0, 0}, 0.1, 1.0)};
  EXPECT_THROW(solids_in_band(world, frame, {}), Error);
}

TEST(Floors, PiecesOfALevelTileWithoutOverlap) {
  for (const World& world : {make_town(2).world, make_office(2).world}) {
    ASSERT_FALSE(world.floors.empty());
    for (std::size_t i = 0; i < world.floors.size(); ++i) {
      for (std::size_t k = 0; k < i; ++k) {
        const auto shared = world.floors[i].area.intersection(world.floors[k].area);
        EXPECT_TRUE(shared.isEmpty() || shared.sizes().minCoeff() < 1e-9);
      }
    }
  }
}

// What a ray straight down meets first on free ground is the floor of the truth.
TEST(Floors, AreWhereRaysFromAboveEnd) {
  Random random{5};
  TownOptions options;
  options.streets = 3;
  const RayCaster caster(make_town(4, options).world);
  int on_ground = 0;
  for (int i = 0; i < 2000; ++i) {
    const Vector3d above{random.uniform(-80.0, 200.0), random.uniform(-80.0, 200.0), 60.0};
    const auto hit = caster.cast(above, -Vector3d::UnitZ(), 0.0, 200.0);
    const auto floor = floor_height(caster.world(), above.x(), above.y());
    if (!hit || (hit->primitive->object_class != ObjectClass::ground &&
                 hit->primitive->object_class != ObjectClass::sidewalk)) {
      continue;
    }
    ++on_ground;
    ASSERT_TRUE(floor);
    EXPECT_NEAR(above.z() - hit->range, *floor, 1e-9);
  }
  EXPECT_GT(on_ground, 500);
  EXPECT_FALSE(floor_height(caster.world(), 0.0, 0.0, 1)) << "no second level";
}

TEST(CrossedCells, AreThoseARayMeetsInsideTheBand) {
  Random random{21};
  const PlanFrame frame{{-2, -2}, 0.25, 16, 16};
  const FloorBand band{0.1, 0.5};
  constexpr int samples = 4000;
  int crossed_cells = 0;
  for (int trial = 0; trial < 300; ++trial) {
    World world;
    world.floors = {piece({-3, -3}, {0.3, 3}, 0.0, {random.uniform(-0.4, 0.4), 0.2}),
                    piece({0.3, -3}, {1.7, 3}, 0.1, {0, 0})};
    const auto where = [&] {
      return Vector3d{
          random.uniform(-3.0, 3.0), random.uniform(-3.0, 3.0), random.uniform(-0.5, 1.0)};
    };
    const Vector3d from = where();
    Vector3d to = where();
    if (trial % 10 == 0) to = from + random.uniform(0.1, 2.0) * Vector3d::Unit(trial / 10 % 3);
    std::vector<std::uint8_t> crossed(frame.size(), 0);
    mark_crossed(world, band, from, to, frame, crossed);
    std::vector<std::uint8_t> seen(frame.size(), 0);
    for (int i = 0; i <= samples; ++i) {
      const Vector3d p = from + static_cast<double>(i) / samples * (to - from);
      const auto floor = floor_height(world, p.x(), p.y());
      const Vector2d cell = (p.head<2>() - frame.lower_left) / frame.resolution;
      if (!floor || cell.minCoeff() < 0.0 || cell.maxCoeff() >= 16.0) continue;
      if (p.z() - *floor < band.z_min || p.z() - *floor > band.z_max) continue;
      seen[frame.index(static_cast<int>(cell.x()), static_cast<int>(cell.y()))] = 1;
    }
    int missed = 0;
    for (std::size_t i = 0; i < seen.size(); ++i) {
      if (seen[i] != 0) {
        EXPECT_EQ(crossed[i], 1) << "trial " << trial << " cell " << i;
      }
      crossed_cells += crossed[i];
      missed += crossed[i] != 0 && seen[i] == 0 ? 1 : 0;
    }
    // Samples are 1.5 mm apart: they miss hardly any cell that is truly crossed.
    EXPECT_LE(missed, 1) << "trial " << trial;
  }
  EXPECT_GT(crossed_cells, 500);
}

// Where a noise-free scan looked through the band, no static solid fills the cell that it crossed
// in the middle: free space and solids agree.
TEST(CrossedCells, OfAScanEndAtTheSolids) {
  const Simulator simulator = make_simulator({"office", "spinning16", "robot", 3, 0, 300, 1.0});
  const PlanFrame frame{{-0.5, -0.5}, 0.05, 820, 520};
  const FloorBand band{0.2, 0.6};
  std::vector<std::uint8_t> crossed(frame.size(), 0);
  for (const std::size_t scan : {100U, 200U})
    mark_crossed(simulator, scan, true, band, frame, crossed);
  World walls = simulator.caster().world();
  std::erase_if(walls.primitives,
                [](const Primitive& p) { return p.object_class != ObjectClass::wall; });
  const PlanTruth truth = solids_in_band(walls, frame, band);
  int free = 0;
  int behind = 0;
  for (int row = 1; row + 1 < frame.rows; ++row) {
    for (int column = 1; column + 1 < frame.columns; ++column) {
      free += crossed[frame.index(column, row)];
      bool buried = true;
      for (int k = 0; k < 9; ++k) {
        buried = buried && truth.touched(column + k % 3 - 1, row + k / 3 - 1);
      }
      behind += buried ? crossed[frame.index(column, row)] : 0;
    }
  }
  EXPECT_GT(free, 2000);
  EXPECT_EQ(behind, 0) << "rays end at walls; these are 12 cm thick";
}

}  // namespace
}  // namespace kissmap::simulator
