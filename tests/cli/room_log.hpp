// SPDX-License-Identifier: MIT
#pragma once

#include <cmath>
#include <filesystem>
#include <limits>
#include <numbers>
#include <vector>

#include "support/small_log.hpp"

namespace kissmap {

/// An upright wall between two places of a level floor at z = 0 [m].
struct RoomWall {
  Eigen::Vector2d from;
  Eigen::Vector2d to;
  double height = 0.0;
};

using RoomWalls = std::vector<RoomWall>;

inline constexpr double room_sensor_height = 1.0;  // m
inline constexpr int room_scans = 3;

/// The four walls of a box; sides along x and y.
inline void add_box(RoomWalls& walls,
                    const Eigen::Vector2d& middle,
                    const Eigen::Vector2d& size,
                    double height) {
  const Eigen::Vector2d low = middle - 0.5 * size;
  const Eigen::Vector2d high = middle + 0.5 * size;
  const Eigen::Vector2d right(high.x(), low.y());
  const Eigen::Vector2d left(low.x(), high.y());
  walls.push_back({low, right, height});
  walls.push_back({right, high, height});
  walls.push_back({high, left, height});
  walls.push_back({left, low, height});
}

/// Turned about the sensor.
inline RoomWalls turned(RoomWalls walls, double angle) {
  for (RoomWall& wall : walls) {
    wall.from = Eigen::Rotation2Dd(angle) * wall.from;
    wall.to = Eigen::Rotation2Dd(angle) * wall.to;
  }
  return walls;
}

/// m along a ray from the sensor, over (0, 0), to what it meets first.
inline double room_range(const RoomWalls& walls, const Eigen::Vector3d& direction) {
  double range = direction.z() < 0.0 ? -room_sensor_height / direction.z()
                                     : std::numeric_limits<double>::infinity();
  for (const RoomWall& wall : walls) {
    const Eigen::Vector2d along = wall.to - wall.from;
    const double square = direction.x() * along.y() - direction.y() * along.x();
    if (std::abs(square) < 1e-12) continue;
    const double way = (wall.from.x() * along.y() - wall.from.y() * along.x()) / square;
    const double part = (wall.from.x() * direction.y() - wall.from.y() * direction.x()) / square;
    const double z = room_sensor_height + way * direction.z();
    if (way > 0.0 && way < range && part >= 0.0 && part <= 1.0 && z <= wall.height) range = way;
  }
  return range;
}

/// A log of a sensor that stands 1 m above the floor, over (0, 0), and sees the same three times:
/// every quarter of a degree around, from 60 degrees below the horizon to 30 above in steps of one.
inline void write_room_log(const std::filesystem::path& folder, const RoomWalls& walls) {
  std::vector<Eigen::Vector3f> points;
  for (int turn = 0; turn < 1440; ++turn) {
    for (int tilt = -60; tilt <= 30; ++tilt) {
      const double yaw = (turn + 0.3) * std::numbers::pi / 720.0;
      const double pitch = (tilt + 0.2) * std::numbers::pi / 180.0;
      const Eigen::Vector3d direction(
          std::cos(pitch) * std::cos(yaw), std::cos(pitch) * std::sin(yaw), std::sin(pitch));
      const double range = room_range(walls, direction);
      if (range < 30.0) points.emplace_back((range * direction).cast<float>());
    }
  }
  std::filesystem::create_directories(folder);
  for (int i = 0; i < room_scans; ++i) write_pcd(folder / scan_name(i), points);
}

}  // namespace kissmap
