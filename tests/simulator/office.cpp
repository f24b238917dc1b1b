// SPDX-License-Identifier: MIT
#include "simulator/office.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

#include "kissmap/error.hpp"
#include "simulator/random.hpp"

namespace kissmap::simulator {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;
constexpr double pi = std::numbers::pi;
constexpr std::uint64_t office_stream = 0x4F464649;

Vector3d lifted(const Vector2d& p, double z = 0.0) {
  return {p.x(), p.y(), z};
}

class OfficeBuilder {
 public:
  OfficeBuilder(std::uint64_t seed, const OfficeOptions& options) : random_{seed, office_stream} {
    office_.options = options;
    const double near = options.room_depth;
    const double inner = near + options.corridor_width;
    office_.ring = {Vector2d(near, near), Vector2d(options.length - near, options.width - near)};
    office_.core = {Vector2d(inner, inner),
                    Vector2d(options.length - inner, options.width - inner)};
    if (office_.core.sizes().minCoeff() < 6.0) {
      throw usage_error(
          "office: the core between the corridors is narrower than 6 m; make the "
          "storey larger or the rooms less deep");
    }
  }

  Office build() {
    add_shell();
    add_outer_rooms();
    add_core_rooms();
    add_corridor_things();
    add_walkers();
    return std::move(office_);
  }

 private:
  void box(ObjectClass what, const Rigid3& frame, const Vector3d& low, const Vector3d& high) {
    office_.world.primitives.push_back(make_box(what, frame, low, high));
  }

  void add_shell() {
    const OfficeOptions& o = office_.options;
    box(ObjectClass::floor, Rigid3{}, {-1, -1, -0.3}, {o.length + 1, o.width + 1, 0});
    office_.world.floors.push_back({{Vector2d(-1, -1), Vector2d(o.length + 1, o.width + 1)}});
    box(ObjectClass::ceiling,
        Rigid3{},
        {-1, -1, o.height},
        {o.length + 1, o.width + 1, o.height + 0.3});
    const Vector2d corners[4] = {{0, 0}, {o.length, 0}, {o.length, o.width}, {0, o.width}};
    for (int k = 0; k < 4; ++k) add_wall(corners[k], corners[(k + 1) % 4], {});
  }

  // A wall with doors, given as distances of their middles from `from`, ascending.
  void add_wall(const Vector2d& from, const Vector2d& to, const std::vector<double>& doors) {
    const OfficeOptions& o = office_.options;
    office_.walls.push_back({from, to});
    const Vector2d along = to - from;
    const Rigid3 wall = planar_frame(lifted(from), std::atan2(along.y(), along.x()));
    const double half = 0.5 * o.wall_thickness;
    // Walls reach into each other, so that corners are tight.
    double begin = -half;
    for (const double door : doors) {
      box(ObjectClass::wall, wall, {begin, -half, 0}, {door - 0.5 * o.door_width, half, o.height});
      begin = door + 0.5 * o.door_width;
      box(ObjectClass::wall,
          wall,
          {door - 0.5 * o.door_width, -half, o.door_height},
          {begin, half, o.height});
    }
    box(ObjectClass::wall, wall, {begin, -half, 0}, {along.norm() + half, half, o.height});
  }

  // A row of rooms behind a corridor wall that runs from `from` to `to`; rooms lie on its left.
  // `first` and `last`: part of the wall on which doors may be.
  void add_row(const Vector2d& from, const Vector2d& to, double depth, double first, double last) {
    const Vector2d along = (to - from).normalized();
    const Vector2d inwards(-along.y(), along.x());
    const double length = (to - from).norm();
    std::vector<double> doors;
    for (double begin = 0.0; length - begin > 1e-9;) {
      double width = random_.uniform(3.6, 6.5);
      if (begin == 0.0) width = std::max(width, first + 2.9);
      const double rest = length - begin - width;
      if (rest < std::max(3.6, length - last + 2.9)) width = length - begin;
      const double end = begin + width;
      const double margin = 0.5 * office_.options.door_width + 0.9;
      const double door =
          random_.uniform(std::max(begin, first) + margin, std::min(end, last) - margin);
      doors.push_back(door);
      const Vector2d a = from + begin * along;
      const Vector2d b = from + end * along + depth * inwards;
      PlanRoom room;
      room.area = {a.cwiseMin(b), a.cwiseMax(b)};
      room.door = {
          from + door * along, inwards, !random_.chance(office_.options.closed_door_share)};
      add_room(room);
      if (begin > 0.0) add_wall(a, a + depth * inwards, {});
      begin = end;
    }
    add_wall(from, to, doors);
  }

  void add_outer_rooms() {
    const OfficeOptions& o = office_.options;
    const Vector2d low = office_.ring.min();
    const Vector2d high = office_.ring.max();
    const double d = o.room_depth;
    // Southern and northern rows run through to the outer walls, the others lie between them.
    add_row({o.length, low.y()}, {0, low.y()}, d, d, o.length - d);
    add_row({0, high.y()}, {o.length, high.y()}, d, d, o.length - d);
    add_row({low.x(), low.y()}, {low.x(), high.y()}, d, 0, high.y() - low.y());
    add_row({high.x(), high.y()}, {high.x(), low.y()}, d, 0, high.y() - low.y());
  }

  void add_core_rooms() {
    const Vector2d low = office_.core.min();
    const Vector2d high = office_.core.max();
    const double length = high.x() - low.x();
    const double depth = 0.5 * (high.y() - low.y());
    add_row(low, {high.x(), low.y()}, depth, 0, length);
    add_row(high, {low.x(), high.y()}, depth, 0, length);
    add_wall({low.x(), low.y()}, {low.x(), high.y()}, {});
    add_wall({high.x(), low.y()}, {high.x(), high.y()}, {});
    add_wall({low.x(), low.y() + depth}, {high.x(), low.y() + depth}, {});
  }

  void add_room(const PlanRoom& room) {
    office_.rooms.push_back(room);
    add_door_leaf(room.door);
    // The room seen from its door: x to the side, y inwards, origin in the doorway.
    const Vector2d in = room.door.into_room;
    const Rigid3 from_door =
        planar_frame(lifted(room.door.middle), std::atan2(in.y(), in.x()) - pi / 2);
    Eigen::AlignedBox2d area;
    for (const auto corner : {Eigen::AlignedBox2d::BottomLeft, Eigen::AlignedBox2d::TopRight}) {
      area.extend((from_door.inverse() * lifted(room.area.corner(corner))).head<2>().eval());
    }
    furnish(from_door, area);
  }

  void add_door_leaf(const PlanDoor& door) {
    const OfficeOptions& o = office_.options;
    const Rigid3 from_door = planar_frame(
        lifted(door.middle), std::atan2(door.into_room.y(), door.into_room.x()) - pi / 2);
    const double angle = door.open ? random_.uniform(1.57, 1.9) : 0.0;
    const Rigid3 hinge = from_door * planar_frame({-0.5 * o.door_width + 0.03, 0.0, 0}, angle);
    box(ObjectClass::door, hinge, {0, -0.02, 0.01}, {o.door_width - 0.06, 0.02, o.door_height});
  }

  // Desks with chairs along the far wall, cabinets along the side walls. A strip behind the door,
  // 1.3 m to each side and 3 m deep, stays free to walk in.
  void furnish(const Rigid3& room, const Eigen::AlignedBox2d& area) {
    const Vector2d low = area.min() + Vector2d::Constant(0.1);
    const Vector2d high = area.max() - Vector2d::Constant(0.1);
    for (double x = low.x() + random_.uniform(0.0, 0.4); x + 1.4 < high.x();) {
      const double width = random_.uniform(1.2, 1.7);
      if (x + width > high.x()) break;
      add_desk(room, {x, high.y() - 0.8}, width);
      x += width + random_.uniform(0.3, 1.4);
    }
    for (const bool left : {true, false}) {
      const double depth = random_.uniform(0.35, 0.6);
      const double near = left ? low.x() : high.x() - depth;
      const double begin = random_.uniform(0.3, 1.4);
      const double end = begin + random_.uniform(0.6, 1.8);
      const bool in_the_way = near + depth > -1.3 && near < 1.3;
      if (in_the_way || end > high.y() - 1.7 || random_.chance(0.2)) continue;
      box(ObjectClass::cabinet,
          room,
          {near, begin, 0},
          {near + depth, end, random_.uniform(0.8, 2.2)});
    }
  }

  // A table top on four legs with things on it; `corner` is its near left corner.
  void add_desk(const Rigid3& room, const Vector2d& corner, double width) {
    constexpr double top = 0.74;
    constexpr double depth = 0.8;
    const Rigid3 desk = room * planar_frame(lifted(corner), 0.0);
    box(ObjectClass::desk, desk, {0, 0, top - 0.03}, {width, depth, top});
    for (const double x : {0.03, width - 0.08}) {
      for (const double y : {0.03, depth - 0.08}) {
        box(ObjectClass::desk_leg, desk, {x, y, 0}, {x + 0.05, y + 0.05, top - 0.03});
      }
    }
    const double screen = random_.uniform(0.1, width - 0.7);
    box(ObjectClass::desk, desk, {screen, 0.5, top + 0.08}, {screen + 0.6, 0.54, top + 0.45});
    if (random_.chance(0.8)) add_chair(desk, random_.uniform(0.3, width - 0.3));
  }

  void add_chair(const Rigid3& desk, double x) {
    const double y = random_.uniform(-0.45, -0.1);
    const Rigid3 chair = desk * planar_frame({x, y, 0}, random_.uniform(-pi, pi));
    for (const double leg_x : {-0.19, 0.19}) {
      for (const double leg_y : {-0.19, 0.19}) {
        office_.world.primitives.push_back(
            make_cylinder(ObjectClass::chair_leg, chair, {leg_x, leg_y, 0}, 0.0125, 0.43));
      }
    }
    box(ObjectClass::chair_seat, chair, {-0.22, -0.22, 0.43}, {0.22, 0.22, 0.47});
    box(ObjectClass::chair_seat, chair, {-0.22, 0.18, 0.5}, {0.22, 0.22, 0.9});
  }

  // Shallow things along the outer sides of the corridors, clear of doors: lockers, printers, bins.
  void add_corridor_things() {
    const Vector2d low = office_.core.min();
    const Vector2d high = office_.core.max();
    const Vector2d corners[4] = {low, {high.x(), low.y()}, high, {low.x(), high.y()}};
    for (int k = 0; k < 4; ++k) {
      const Vector2d along = corners[(k + 1) % 4] - corners[k];
      const Rigid3 side = planar_frame(lifted(corners[k]), std::atan2(along.y(), along.x()));
      for (double x = random_.uniform(0.5, 3.0); x + 1.2 < along.norm();) {
        const double width = random_.uniform(0.3, 1.2);
        const double depth = random_.uniform(0.2, 0.35);
        const double height = random_.uniform(0.6, 2.0);
        if (clear_of_doors(side * Vector3d(x + 0.5 * width, 0, 0), 0.5 * width + 0.2)) {
          box(ObjectClass::cabinet, side, {x, -depth - 0.06, 0}, {x + width, -0.06, height});
        }
        x += width + random_.uniform(2.0, 6.0);
      }
    }
  }

  bool clear_of_doors(const Vector3d& place, double reach) const {
    const double needed = reach + 0.5 * office_.options.door_width;
    return std::ranges::none_of(office_.rooms, [&](const PlanRoom& room) {
      return (room.door.middle - place.head<2>()).norm() < needed;
    });
  }

  void add_walkers() {
    for (int k = 0; k < office_.options.walkers; ++k) {
      if (k < 4 || k % 2 == 0) {
        add_corridor_walker(k);
      } else {
        add_room_walker(k / 2);
      }
    }
  }

  // People keep to the outer edge of the corridors.
  void add_corridor_walker(int k) {
    const Vector2d low = office_.ring.min() + Vector2d::Constant(0.4);
    const Vector2d high = office_.ring.max() - Vector2d::Constant(0.4);
    const Vector2d corners[4] = {low, {high.x(), low.y()}, high, {low.x(), high.y()}};
    const Vector2d from = corners[k % 4];
    const Vector2d along = corners[(k + 1) % 4] - from;
    const double begin = random_.uniform(0.05, 0.3);
    const double end = random_.uniform(0.6, 0.95);
    add_person(from + begin * along, (end - begin) * along);
  }

  // To and fro behind the door of an outer room, where robots do not go.
  void add_room_walker(int k) {
    std::vector<const PlanRoom*> outer;
    for (const PlanRoom& room : office_.rooms) {
      if (!office_.core.contains(room.area.center())) outer.push_back(&room);
    }
    const PlanDoor& door = outer[static_cast<std::size_t>(k) % outer.size()]->door;
    const Vector2d aside(-door.into_room.y(), door.into_room.x());
    const double depth = random_.uniform(1.5, 2.6);
    add_person(door.middle + depth * door.into_room - 0.9 * aside, 1.8 * aside);
  }

  void add_person(const Vector2d& from, const Vector2d& way) {
    const Rigid3 start = planar_frame(lifted(from), 0.0);
    MovingObject person;
    person.parts.push_back(make_cylinder(ObjectClass::pedestrian, start, {0, 0, 0}, 0.2, 1.45));
    person.parts.push_back(make_cylinder(ObjectClass::pedestrian, start, {0, 0, 1.45}, 0.1, 0.27));
    const Vector3d travel = lifted(way);
    person.shuttle = {travel, travel.norm() * random_.uniform(2.5, 3.5), random_.uniform()};
    office_.world.moving.push_back(person);
  }

  Office office_;
  Random random_;
};

}  // namespace

Office make_office(std::uint64_t seed, const OfficeOptions& options) {
  return OfficeBuilder(seed, options).build();
}

}  // namespace kissmap::simulator
