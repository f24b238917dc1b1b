// SPDX-License-Identifier: MIT
#include "kissmap/mapping/mapper.hpp"

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

Mapper::Mapper(const OdometryOptions& odometry,
               const LocalMapOptions& local_maps,
               ThreadPool& pool,
               SplittingRule splitting_rule)
    : odometry_(odometry, pool),
      splitting_rule_(std::move(splitting_rule)),
      grid_((require_valid(local_maps), local_maps.voxel_size), local_maps.max_points_per_voxel) {
  if (!splitting_rule_) splitting_rule_ = split_by_displacement(local_maps.splitting_distance);
}

MapperStep Mapper::add(const Scan& scan) {
  if (const auto refusal = check_stamp(scan)) return {*refusal, std::nullopt};
  const std::optional<RegisteredScan> registered = odometry_.register_scan(scan);
  if (!registered) return {ScanRefusal::no_points, std::nullopt};
  last_stamp_ = scan.stamp_ns;
  grid_.add(registered->map_points);
  MapperStep step{place(scan, *registered), std::nullopt};
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

MappedScan Mapper::place(const Scan& scan, const RegisteredScan& registered) {
  MappedScan mapped;
  mapped.stamp_ns = scan.stamp_ns;
  mapped.pose_stamp_ns = scan.stamp_ns;
  if (registered.deskewed) {
    const auto offset = static_cast<double>(time_span(scan)->last);
    mapped.pose_stamp_ns += static_cast<std::int64_t>(std::llround(offset * 1e9));
  }
  mapped.local_map_id = local_map_id_;
  mapped.local_map_from_lidar = registered.frame_from_lidar;
  mapped.map_from_lidar = map_from_local_map_ * registered.frame_from_lidar;
  mapped.deskewed = registered.deskewed;
  mapped.sweep_start_from_sweep_end = registered.sweep_start_from_sweep_end;
  mapped.points_read = scan.points.size();
  mapped.points_in_range = registered.points_in_range;
  mapped.iterations = static_cast<std::uint32_t>(registered.iterations);
  // The very first scan has no map to be registered to.
  const bool first = local_map_id_ == 0 && progress_.scan_count == 0;
  mapped.converged = first || registered.end == Alignment::End::converged;

  const Rigid3& local_map_from_lidar = registered.frame_from_lidar;
  progress_.path_length +=
      (local_map_from_last_.inverse() * local_map_from_lidar).translation.norm();
  progress_.displacement = local_map_from_lidar.translation.norm();
  ++progress_.scan_count;
  local_map_from_last_ = local_map_from_lidar;
  return mapped;
}

LocalMap Mapper::close(LocalMapEnd end) {
  LocalMap local_map;
  local_map.id = local_map_id_;
  local_map.map_from_local_map = map_from_local_map_;
  local_map.surfels = surfels_from_grid(grid_);
  local_map.scan_count = progress_.scan_count;
  local_map.path_length = progress_.path_length;
  local_map.displacement = progress_.displacement;
  local_map.end = end;

  // The next keypose is the last scan's pose; odometry and grid go on from the odometry's map.
  map_from_local_map_ = map_from_local_map_ * local_map_from_last_;
  local_map_from_last_ = Rigid3{};
  progress_ = {};
  ++local_map_id_;
  odometry_.restart_frame();
  grid_.clear();
  grid_.add(odometry_.map().points());
  return local_map;
}

}  // namespace kissmap
