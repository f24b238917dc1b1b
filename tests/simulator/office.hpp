// SPDX-License-Identifier: MIT
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cstdint>
#include <vector>

#include "simulator/world.hpp"

namespace kissmap::simulator {

struct OfficeOptions {
  double length = 40.0;            ///< m, along x, inside the outer walls
  double width = 25.0;             ///< m, along y
  double height = 2.8;             ///< m, floor to ceiling
  double room_depth = 5.5;         ///< m, of the outer rooms
  double corridor_width = 2.0;     ///< m
  double wall_thickness = 0.12;    ///< m
  double door_width = 1.0;         ///< m
  double door_height = 2.1;        ///< m
  double closed_door_share = 0.2;  ///< of the doors
  int walkers = 4;                 ///< people in the corridors; from the fifth on also in rooms
};

/// A straight wall, as the middle of its thickness. Doors are gaps in it below door_height.
struct PlanWall {
  Eigen::Vector2d from = Eigen::Vector2d::Zero();  ///< m
  Eigen::Vector2d to = Eigen::Vector2d::Zero();
};

struct PlanDoor {
  Eigen::Vector2d middle = Eigen::Vector2d::Zero();      ///< m, in the wall
  Eigen::Vector2d into_room = Eigen::Vector2d::UnitX();  ///< unit, from corridor to room
  bool open = true;
};

struct PlanRoom {
  Eigen::AlignedBox2d area;  ///< m, between the middles of its walls
  PlanDoor door;
};

/// One storey: a ring corridor between outer rooms and a core, with doors, desks, chairs, cabinets
/// and people walking. Floor at z = 0; the corner of the outer walls is the origin.
struct Office {
  World world;
  OfficeOptions options;
  std::vector<PlanWall> walls;  ///< the exact floor plan
  std::vector<PlanRoom> rooms;
  Eigen::AlignedBox2d core;  ///< m, inner border of the ring corridor
  Eigen::AlignedBox2d ring;  ///< m, outer border of the ring corridor
};

/// The same office for the same seed and options. Throws Error(usage) where the sizes leave no
/// core.
Office make_office(std::uint64_t seed, const OfficeOptions& options = {});

}  // namespace kissmap::simulator
