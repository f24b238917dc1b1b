// SPDX-License-Identifier: MIT
#include "end_to_end/map_in_world.hpp"

#include <cmath>
#include <vector>

#include "kissmap/formats/product_frame.hpp"
#include "kissmap/formats/session.hpp"

namespace kissmap {
namespace {

/// The motion in the plane that brings one set of places onto another with the least squares.
Pose2 aligned(const std::vector<Eigen::Vector2d>& from, const std::vector<Eigen::Vector2d>& to) {
  Eigen::Vector2d from_mean = Eigen::Vector2d::Zero();
  Eigen::Vector2d to_mean = Eigen::Vector2d::Zero();
  for (std::size_t i = 0; i < from.size(); ++i) {
    from_mean += from[i] / static_cast<double>(from.size());
    to_mean += to[i] / static_cast<double>(from.size());
  }
  double along = 0.0;
  double across = 0.0;
  for (std::size_t i = 0; i < from.size(); ++i) {
    const Eigen::Vector2d a = from[i] - from_mean;
    const Eigen::Vector2d b = to[i] - to_mean;
    along += a.dot(b);
    across += a.x() * b.y() - a.y() * b.x();
  }
  const double yaw = std::atan2(across, along);
  const Eigen::Vector2d shift = to_mean - Eigen::Rotation2Dd(yaw) * from_mean;
  return {shift.x(), shift.y(), yaw};
}

}  // namespace

Pose2 world_from_level(const std::filesystem::path& path, const simulator::Simulator& simulator) {
  const Session session = read_session(path);
  const Rigid3 level = level_from_map(session);
  std::vector<Eigen::Vector2d> found;
  std::vector<Eigen::Vector2d> truth;
  for (const SessionScan& scan : session.scans) {
    found.emplace_back((level * scan.mapped.map_from_lidar.translation).head<2>());
    truth.emplace_back(simulator.map_from_lidar(scan.mapped.pose_stamp_ns).translation.head<2>());
  }
  return aligned(found, truth);
}

GridMap map_in_world(const OccupancyPlan& plan,
                     const Pose2& world_from_plan,
                     const Eigen::AlignedBox2d& area) {
  GridMap map;
  map.resolution = plan.resolution;
  map.corner = area.min();
  map.width = static_cast<int>(area.sizes().x() / map.resolution);
  map.height = static_cast<int>(area.sizes().y() / map.resolution);
  const Pose2 plan_from_world = world_from_plan.inverse();
  for (int y = 0; y < map.height; ++y) {
    for (int x = 0; x < map.width; ++x) {
      const Eigen::Vector2d middle =
          map.corner + Eigen::Vector2d(x + 0.5, y + 0.5) * map.resolution;
      const Pose2 place = plan_from_world * Pose2{middle.x(), middle.y(), 0.0};
      const Eigen::Vector2d cell =
          (Eigen::Vector2d(place.x, place.y) - plan.origin) / plan.resolution;
      const auto column = static_cast<int>(std::floor(cell.x()));
      const auto row = static_cast<int>(std::floor(cell.y()));
      GridCell& made = map.cells.emplace_back();
      if (!plan.contains(column, row)) continue;
      const PlanCell state = plan.cells[plan.index(column, row)];
      made.state = state == PlanCell::occupied ? CellState::occupied
                   : state == PlanCell::free   ? CellState::free
                                               : CellState::unknown;
    }
  }
  return map;
}

}  // namespace kissmap
