// SPDX-License-Identifier: MIT
#include "kissmap/mapping/mapper.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "kissmap/mapping/surfels.hpp"
#include "options.hpp"

namespace kissmap {

void require_valid(const LocalMapOptions& options) {
  require_between("local_map_voxel_size", options.voxel_size, 0.01, 100.0);
  require_between("local_map_points_per_voxel",
                  options.max_points_per_voxel,
                  static_cast<double>(min_points_per_surfel),
                  VoxelHashMap::capacity);
  require_between("splitting_distance", options.splitting_distance, 1.0, 1e5);
}

const char* to_string(ScanRefusal refusal) {
  switch (refusal) {
    case ScanRefusal::no_points:
      return "no usable point in range";
    case ScanRefusal::stamp_repeated:
      return "stamp equals that of the last scan used";
    case ScanRefusal::stamp_out_of_order:
      return "stamp earlier than that of the last scan used";
  }
  return "unknown";
}

namespace {

constexpr double opening_ranges = 1.0 / 3.0;
constexpr double shortest_opening = 3.0;     // m
constexpr double longest_opening = 10.0;     // m
constexpr double path_step = 0.5;            // m
constexpr double shortest_local_map = 10.0;  // m

}  // namespace

Mapper::Mapper(const OdometryOptions& odometry,
               const LocalMapOptions& local_maps,
               ThreadPool& pool,
               SplittingRule splitting_rule)
    : odometry_(odometry, pool),
      splitting_rule_(std::move(splitting_rule)),
      grid_((require_valid(local_maps), local_maps.voxel_size), local_maps.max_points_per_voxel),
      opening_grid_(local_maps.voxel_size, local_maps.max_points_per_voxel),
      frame_reach_(local_maps.splitting_distance) {
  if (!splitting_rule_) {
    splitting_rule_ = split_by_range(std::min(shortest_local_map, local_maps.splitting_distance),
                                     local_maps.splitting_distance);
  }
}

MapperStep Mapper::add(const Scan& scan) {
  if (const auto refusal = check_stamp(scan)) return {*refusal, std::nullopt};
  const std::optional<RegisteredScan> registered = odometry_.register_scan(scan);
  if (!registered) return {ScanRefusal::no_points, std::nullopt};
  last_stamp_ = scan.stamp_ns;
  MapperStep step{place(scan, *registered), std::nullopt};
  fill_grids(registered->map_points);
  if (splitting_rule_(progress_)) step.closed = close(LocalMapEnd::split);
  return step;
}

std::optional<LocalMap> Mapper::finish() {
  if (progress_.scan_count == 0) return std::nullopt;
  return close(LocalMapEnd::end_of_log);
}

std::optional<ScanRefusal> Mapper::check_stamp(const Scan& scan) const {
  if (!last_stamp_ || scan.stamp_ns > *last_stamp_) return std::nullopt;
  return scan.stamp_ns == *last_stamp_ ? ScanRefusal::stamp_repeated
                                       : ScanRefusal::stamp_out_of_order;
}

bool Mapper::still_opening() const {
  const double length =
      std::clamp(opening_ranges * progress_.mean_range, shortest_opening, longest_opening);
  // Only scans in a row: who comes back to the keypose brings drift along.
  return opening_scans_ + 1 == progress_.scan_count && progress_.displacement < length;
}

void Mapper::fill_grids(std::span<const Eigen::Vector3f> points_in_frame) {
  const Rigid3 local_map_from_frame = frame_from_local_map_.inverse();
  const Eigen::Matrix3f rotation = local_map_from_frame.rotation.toRotationMatrix().cast<float>();
  const Eigen::Vector3f translation = local_map_from_frame.translation.cast<float>();
  grid_points_.clear();
  for (const Eigen::Vector3f& point : points_in_frame) {
    grid_points_.emplace_back(rotation * point + translation);
  }
  grid_.add(grid_points_);
  if (!still_opening()) return;
  opening_grid_.add(grid_points_);
  ++opening_scans_;
}

MappedScan Mapper::place(const Scan& scan, const RegisteredScan& registered) {
  MappedScan mapped;
  mapped.stamp_ns = scan.stamp_ns;
  mapped.pose_stamp_ns = scan.stamp_ns;
  if (registered.deskewed) {
    const auto offset = static_cast<double>(time_span(scan)->last);
    mapped.pose_stamp_ns += static_cast<std::int64_t>(std::llround(offset * 1e9));
  }
  mapped.local_map_id = local_map_id_;
  const Rigid3 local_map_from_lidar = frame_from_local_map_.inverse() * registered.frame_from_lidar;
  mapped.local_map_from_lidar = local_map_from_lidar;
  mapped.map_from_lidar = map_from_local_map_ * local_map_from_lidar;
  mapped.deskewed = registered.deskewed;
  mapped.sweep_start_from_sweep_end = registered.sweep_start_from_sweep_end;
  mapped.points_read = scan.points.size();
  mapped.points_in_range = registered.points_in_range;
  mapped.iterations = static_cast<std::uint32_t>(registered.iterations);
  // The very first scan has no map to be registered to.
  const bool first = local_map_id_ == 0 && progress_.scan_count == 0;
  mapped.converged = first || registered.end == Alignment::End::converged;

  path_length_ += (local_map_from_lidar.translation - local_map_from_last_.translation).norm();
  const double step = (local_map_from_lidar.translation - last_corner_).norm();
  if (step > path_step) {
    progress_.path_length += step;
    last_corner_ = local_map_from_lidar.translation;
  }
  progress_.displacement = local_map_from_lidar.translation.norm();
  ++progress_.scan_count;
  progress_.mean_range +=
      (registered.mean_range - progress_.mean_range) / static_cast<double>(progress_.scan_count);
  local_map_from_last_ = local_map_from_lidar;
  frame_from_last_ = registered.frame_from_lidar;
  return mapped;
}

LocalMap Mapper::close(LocalMapEnd end) {
  LocalMap local_map;
  local_map.id = local_map_id_;
  local_map.map_from_local_map = map_from_local_map_;
  local_map.surfels = surfels_from_grid(grid_);
  local_map.points = grid_.points();
  local_map.opening = surfels_from_grid(opening_grid_);
  local_map.opening_scans = opening_scans_;
  local_map.scan_count = progress_.scan_count;
  local_map.path_length = path_length_;
  local_map.displacement = progress_.displacement;
  local_map.end = end;

  // The next keypose is the last scan's pose. The grid starts empty: a local map shows what was
  // seen while it was open, so that two of them are independent witnesses of a place. (The
  // published grid starts from the odometry's map. Indoors that holds the whole building, and every
  // local map would match the one before by its own copies.)
  map_from_local_map_ = map_from_local_map_ * local_map_from_last_;
  local_map_from_last_ = Rigid3{};
  progress_ = {};
  path_length_ = 0.0;
  last_corner_.setZero();
  ++local_map_id_;
  grid_.clear();
  opening_grid_.clear();
  opening_scans_ = 0;
  // Odometry keeps its frame for as long as it is near: putting its map into other voxels costs
  // points, and where local maps are split should not change the trajectory.
  frame_from_local_map_ = frame_from_last_;
  if (frame_from_last_.translation.norm() > frame_reach_) {
    odometry_.restart_frame();
    frame_from_local_map_ = Rigid3{};
    frame_from_last_ = Rigid3{};
  }
  return local_map;
}

}  // namespace kissmap
