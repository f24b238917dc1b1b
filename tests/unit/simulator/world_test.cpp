// SPDX-License-Identifier: MIT
#include "simulator/world.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>

#include "kissmap/error.hpp"
#include "simulator/office.hpp"
#include "simulator/town.hpp"

namespace kissmap::simulator {
namespace {

using Eigen::Vector3d;

std::map<ObjectClass, int> census(const World& world) {
  std::map<ObjectClass, int> counts;
  for (const Primitive& primitive : world.primitives) ++counts[primitive.object_class];
  for (const MovingObject& object : world.moving) ++counts[object.parts.front().object_class];
  return counts;
}

bool same(const World& a, const World& b) {
  return a.moving.size() == b.moving.size() &&
         std::ranges::equal(a.primitives, b.primitives, [](const Primitive& p, const Primitive& q) {
           return p.object_class == q.object_class && p.half_extents == q.half_extents &&
                  p.world_from_object.translation == q.world_from_object.translation &&
                  p.world_from_object.rotation.coeffs() == q.world_from_object.rotation.coeffs();
         });
}

TEST(Town, IsTheSameForTheSameSeedOnly) {
  EXPECT_TRUE(same(make_town(5).world, make_town(5).world));
  EXPECT_FALSE(same(make_town(5).world, make_town(6).world));
}

TEST(Town, HasEverythingATownHas) {
  const auto counts = census(make_town(1).world);
  EXPECT_EQ(counts.at(ObjectClass::ground), 1);
  EXPECT_EQ(counts.at(ObjectClass::sidewalk), 36);
  EXPECT_GT(counts.at(ObjectClass::building), 1000);
  for (const ObjectClass some : {ObjectClass::fence,
                                 ObjectClass::hedge,
                                 ObjectClass::trunk,
                                 ObjectClass::crown,
                                 ObjectClass::pole,
                                 ObjectClass::parked_car}) {
    EXPECT_GT(counts.at(some), 50) << name(some);
  }
  EXPECT_EQ(counts.at(ObjectClass::moving_car), TownOptions{}.moving_cars);
  EXPECT_EQ(counts.at(ObjectClass::pedestrian), TownOptions{}.pedestrians);
}

// A town that repeats itself is ambiguous for loop closing.
TEST(Town, StreetsAreUnevenlySpaced) {
  const Town town = make_town(1);
  std::vector<double> spacings;
  for (std::size_t k = 1; k < town.x_of_street.size(); ++k) {
    spacings.push_back(town.x_of_street[k] - town.x_of_street[k - 1]);
    spacings.push_back(town.y_of_street[k] - town.y_of_street[k - 1]);
  }
  std::ranges::sort(spacings);
  EXPECT_GT(spacings.back() - spacings.front(), 5.0);
  EXPECT_GE(spacings.front(), TownOptions{}.min_spacing);
  EXPECT_LE(spacings.back(), TownOptions{}.max_spacing);
}

TEST(Town, MovingObjectsMoveAtTheirPace) {
  for (const MovingObject& object : make_town(2).world.moving) {
    const bool car = object.parts.front().object_class == ObjectClass::moving_car;
    double fastest = 0.0;
    for (double t = 0.0; t < object.shuttle.period; t += 0.1) {
      const Vector3d step = object.shuttle.offset(t + 0.1) - object.shuttle.offset(t);
      fastest = std::max(fastest, step.norm() / 0.1);
    }
    EXPECT_GT(fastest, car ? 3.0 : 0.8);
    EXPECT_LT(fastest, car ? 9.0 : 2.0);
  }
}

TEST(Office, IsTheSameForTheSameSeedOnly) {
  EXPECT_TRUE(same(make_office(5).world, make_office(5).world));
  EXPECT_FALSE(same(make_office(5).world, make_office(6).world));
}

double distance_to(const World& world, const Vector3d& point, ObjectClass only) {
  double nearest = 1e9;
  for (const Primitive& primitive : world.primitives) {
    if (primitive.object_class == only)
      nearest = std::min(nearest, signed_distance(primitive, point));
  }
  return nearest;
}

TEST(Office, WallsStandWhereThePlanSaysAndDoorsAreGaps) {
  for (const std::uint64_t seed : {1, 2, 3, 4, 5}) {
    const Office office = make_office(seed);
    const auto in_a_doorway = [&](const Eigen::Vector2d& p) {
      return std::ranges::any_of(office.rooms, [&](const PlanRoom& room) {
        return (room.door.middle - p).norm() < 0.5 * office.options.door_width;
      });
    };
    for (const PlanWall& wall : office.walls) {
      for (double part = 0.01; part < 1.0; part += 0.037) {
        const Eigen::Vector2d p = wall.from + part * (wall.to - wall.from);
        const double low = distance_to(office.world, {p.x(), p.y(), 1.0}, ObjectClass::wall);
        const double high = distance_to(office.world, {p.x(), p.y(), 2.4}, ObjectClass::wall);
        EXPECT_EQ(low > 0.0, in_a_doorway(p));
        EXPECT_LT(high, 0.0) << "lintels close the wall above doors";
      }
    }
  }
}

TEST(Office, RoomsTileTheStoreyAndHaveDoorsInTheirBorder) {
  for (const std::uint64_t seed : {1, 2, 3, 4, 5}) {
    const Office office = make_office(seed);
    double area = office.ring.volume() - office.core.volume();
    for (const PlanRoom& room : office.rooms) {
      area += room.area.volume();
      const Eigen::Vector2d& door = room.door.middle;
      EXPECT_NEAR(room.area.exteriorDistance(door), 0.0, 1e-9);
      EXPECT_TRUE(room.area.contains(Eigen::Vector2d(door + 1.0 * room.door.into_room)));
      EXPECT_TRUE(office.ring.contains(Eigen::Vector2d(door - 1.0 * room.door.into_room)));
    }
    EXPECT_NEAR(area, office.options.length * office.options.width, 1e-6);
  }
}

TEST(Office, HasEverythingAnOfficeHas) {
  const auto counts = census(make_office(1).world);
  for (const ObjectClass some : {ObjectClass::wall,
                                 ObjectClass::door,
                                 ObjectClass::desk,
                                 ObjectClass::chair_leg,
                                 ObjectClass::chair_seat,
                                 ObjectClass::cabinet}) {
    EXPECT_GT(counts.at(some), 10) << name(some);
  }
  EXPECT_EQ(counts.at(ObjectClass::chair_leg) % 4, 0);
  EXPECT_EQ(counts.at(ObjectClass::pedestrian), OfficeOptions{}.walkers);
}

TEST(Office, FurnitureStaysInsideTheStorey) {
  for (const std::uint64_t seed : {1, 2, 3}) {
    const Office office = make_office(seed);
    const Eigen::AlignedBox3d storey(
        Vector3d(-0.1, -0.1, -0.31),
        Vector3d(office.options.length + 0.1, office.options.width + 0.1, 3.2));
    for (const Primitive& primitive : office.world.primitives) {
      if (primitive.object_class == ObjectClass::floor) continue;
      if (primitive.object_class == ObjectClass::ceiling) continue;
      EXPECT_TRUE(storey.contains(primitive.world_from_object.translation))
          << name(primitive.object_class);
    }
  }
}

TEST(Office, RefusesAStoreyWithoutRoomForACore) {
  OfficeOptions options;
  options.width = 18.0;
  EXPECT_THROW(make_office(1, options), Error);
}

TEST(SignedDistance, KnowsBoxesAndCylinders) {
  const Primitive box =
      make_box(ObjectClass::wall, planar_frame({1, 0, 0}, 0.5), {-1, -2, -3}, {1, 2, 3});
  EXPECT_NEAR(signed_distance(box, {1, 0, 5}), 2.0, 1e-12);
  EXPECT_NEAR(signed_distance(box, {1, 0, 0}), -1.0, 1e-12);
  const Primitive pole = make_cylinder(ObjectClass::pole, Rigid3{}, {0, 0, 0}, 0.5, 2.0);
  EXPECT_NEAR(signed_distance(pole, {3.5, 4.0 - 4.0, 1.0}), 3.0, 1e-12);
  EXPECT_NEAR(signed_distance(pole, {0.8, 0.0, 2.4}), 0.5, 1e-12);
  EXPECT_NEAR(signed_distance(pole, {0.0, 0.0, 1.9}), -0.1, 1e-12);
}

}  // namespace
}  // namespace kissmap::simulator
