// SPDX-License-Identifier: MIT
#include "formats/products/grid_survey.hpp"

#include <algorithm>

#include "kissmap/formats/session_replay.hpp"
#include "kissmap/grid/levels.hpp"
#include "kissmap/grid/wall_direction.hpp"

namespace kissmap {
namespace {

constexpr double floor_cell = 0.25;   // m
constexpr double floor_reach = 25.0;  // m

constexpr double least_speed = 0.2;          // m/s; slower is standing
constexpr double least_of_cars = 2.5;        // m/s; people walk, robots roll at less
constexpr double half_width_on_foot = 0.25;  // m, of people, and of robots that get through doors
constexpr double half_width_of_cars = 0.8;   // m

Rigid3 turned_along_walls(const Session& session, const Rigid3& level_from_map) {
  std::vector<Eigen::Vector3f> normals;
  for (const LocalMap& local_map : session.local_maps) {
    const Eigen::Matrix3f rotation =
        (level_from_map.rotation * local_map.map_from_local_map.rotation)
            .toRotationMatrix()
            .cast<float>();
    const SurfelCloud surfels = read_local_map_surfels(session.path, local_map.id);
    for (const Eigen::Vector3f& normal : surfels.normals) normals.emplace_back(rotation * normal);
  }
  Rigid3 aligned;
  aligned.rotation = Eigen::AngleAxisd(-wall_direction(normals), Eigen::Vector3d::UnitZ());
  return aligned * level_from_map;
}

/// m: what goes faster than people walk is as wide as a car.
double carrier_half_width(const Session& session) {
  std::vector<double> speeds;  // m/s
  for (std::size_t i = 1; i < session.scans.size(); ++i) {
    const MappedScan& from = session.scans[i - 1].mapped;
    const MappedScan& to = session.scans[i].mapped;
    const double way = (to.map_from_lidar.translation - from.map_from_lidar.translation).norm();
    const double time = 1e-9 * static_cast<double>(to.pose_stamp_ns - from.pose_stamp_ns);
    if (time > 0.0 && way > least_speed * time) speeds.push_back(way / time);
  }
  if (speeds.empty()) return half_width_on_foot;
  const auto middle = speeds.begin() + static_cast<std::ptrdiff_t>(speeds.size() / 2);
  std::ranges::nth_element(speeds, middle);
  return *middle > least_of_cars ? half_width_of_cars : half_width_on_foot;
}

void extend(const PlacedScan& scan,
            const Rigid3& level_from_lidar,
            const GridExportOptions& options,
            Eigen::AlignedBox2d& seen) {
  const Eigen::Vector2d sensor = level_from_lidar.translation.head<2>();
  const double reach = std::min(options.belief.no_return_range, options.max_range);
  seen.extend(Eigen::Vector2d(sensor.array() - reach));
  seen.extend(Eigen::Vector2d(sensor.array() + reach));
  for (const Eigen::Vector3f& point : scan.points) {
    seen.extend((level_from_lidar * point.cast<double>()).head<2>());
  }
}

}  // namespace

SensorPath GridSurvey::path_on(std::uint32_t level) const {
  SensorPath found;
  for (std::size_t i = 0; i < path.size(); ++i) {
    if (levels[i] == level) found.push_back(path[i]);
  }
  return found;
}

std::vector<SensorPath> GridSurvey::stretches_on(std::uint32_t level) const {
  std::vector<SensorPath> stretches;
  for (std::size_t i = 0; i < path.size(); ++i) {
    if (levels[i] != level) continue;
    if (i == 0 || levels[i - 1] != level) stretches.emplace_back();
    stretches.back().push_back(path[i]);
  }
  return stretches;
}

FloorMap GridSurvey::floor_of(std::uint32_t level) const {
  if (!(sensor_height > 0.0)) return {};
  return floor_under(path_on(level), samples, floor_cell, sensor_height);
}

double GridSurvey::height_of(std::uint32_t level) const {
  const SensorPath there = path_on(level);
  double sum = 0.0;
  for (const Eigen::Vector3d& place : there) sum += place.z() - sensor_height;
  return sum / static_cast<double>(std::max<std::size_t>(1, there.size()));
}

GridSurvey survey_session(const Session& session,
                          const GridExportOptions& options,
                          const ExportProgress& progress) {
  GridSurvey survey;
  survey.level_from_map = level_from_map(session);
  survey.half_width = carrier_half_width(session);
  if (options.align_axes) {
    survey.level_from_map = turned_along_walls(session, survey.level_from_map);
  }
  FloorSampler sampler(floor_cell, floor_reach);
  const auto look = [&](const PlacedScan& scan) {
    if (options.floor_reference) sampler.add(scan, survey.level_from_map);
    if (options.floor_reference) survey.upright.add(scan, survey.level_from_map);
    survey.path.push_back(survey.level_from_map * scan.map_from_lidar.translation);
    extend(scan, survey.level_from_map * scan.map_from_lidar, options, survey.seen);
  };
  for_each_placed_scan(session, options, "looking for the floor", progress, look);
  survey.samples = sampler.samples();
  survey.sensor_height = sensor_height(survey.path, survey.samples, floor_cell);
  survey.levels.assign(survey.path.size(), 0);
  if (options.floor_reference) survey.levels = levels_of(survey.path);
  if (!survey.levels.empty()) survey.level_count = *std::ranges::max_element(survey.levels) + 1;
  return survey;
}

void for_each_placed_scan(const Session& session,
                          const GridExportOptions& options,
                          const char* what,
                          const ExportProgress& progress,
                          const std::function<void(const PlacedScan&)>& call) {
  SessionReplay replay(session, options.min_range, options.max_range, options.moved_log);
  while (const std::optional<PlacedScan> scan = replay.next()) {
    call(*scan);
    progress(what, scan->scan_idx + 1, replay.size());
  }
}

}  // namespace kissmap
