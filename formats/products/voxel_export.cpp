// SPDX-License-Identifier: MIT
#include "kissmap/formats/voxel_export.hpp"

#include <functional>
#include <optional>
#include <sstream>

#include "formats/products/export_resolution.hpp"
#include "formats/products/export_target.hpp"
#include "formats/voxels/voxel_writer.hpp"
#include "kissmap/error.hpp"
#include "kissmap/formats/session_replay.hpp"
#include "kissmap/occupancy/voxel_mapper.hpp"

namespace kissmap {
namespace {

namespace fs = std::filesystem;

void require_between(const char* name, double value, double low, double high) {
  if (value >= low && value <= high) return;  // NaN is in no range
  std::ostringstream message;
  message << name << " = " << value << " is outside " << low << ".." << high;
  throw usage_error(message.str());
}

void require_options(const VoxelExportOptions& options) {
  const LogOddsOptions belief;
  if (options.resolution != 0.0) require_between("--resolution", options.resolution, 0.01, 10.0);
  require_between("--threshold", options.threshold, belief.min_probability, belief.max_probability);
  require_between("--no-return-range", options.no_return_range, 0.0, 1000.0);
}

void for_each_scan(const Session& session,
                   const VoxelExportOptions& options,
                   const char* what,
                   const ExportProgress& progress,
                   const std::function<void(PlacedScan&)>& call) {
  SessionReplay replay(session, options.min_range, options.max_range, options.moved_log);
  while (std::optional<PlacedScan> scan = replay.next()) {
    call(*scan);
    progress(what, scan->scan_idx + 1, replay.size());
  }
}

/// By all scans, as export_grid() does it, so that both products agree.
double choose_resolution(const Session& session,
                         const VoxelExportOptions& options,
                         const ExportProgress& progress) {
  MeanRange range;
  for_each_scan(session, options, "choosing a resolution", progress, [&range](PlacedScan& scan) {
    range.add(scan);
  });
  return resolution_for(range.value());
}

void count_voxels(const OccupancyMap& map, VoxelExportSummary& summary) {
  map.for_each_voxel([&](const Voxel&, LogOdds value) {
    ++(map.steps().is_occupied(value) ? summary.occupied : summary.free);
  });
  summary.memory_bytes = map.memory_bytes();
}

}  // namespace

VoxelExportSummary export_voxels(const Session& session,
                                 const fs::path& output,
                                 const VoxelExportOptions& options,
                                 ThreadPool& pool,
                                 const ExportProgress& progress) {
  require_options(options);
  if (!voxel_format(output)) throw wrong_voxel_ending(output);
  require_file_target(output, options.overwrite);
  VoxelExportSummary summary;
  summary.level_from_map = level_from_map(session);
  summary.resolution = options.resolution == 0.0 ? choose_resolution(session, options, progress)
                                                 : options.resolution;
  OccupancyGeometry geometry;
  geometry.voxel_size.setConstant(summary.resolution);
  VoxelMapperOptions mapping;
  mapping.occupancy.log_odds.occupied_probability = options.threshold;
  mapping.no_return_range = options.no_return_range;
  VoxelMapper mapper(geometry, mapping);
  for_each_scan(session, options, "casting rays", progress, [&](PlacedScan& scan) {
    scan.map_from_lidar = summary.level_from_map * scan.map_from_lidar;
    const OccupancyUpdate update = mapper.add(scan, pool);
    ++summary.scans;
    summary.rays += update.rays;
    summary.skipped_rays += update.non_finite + update.too_far;
  });
  count_voxels(mapper.map(), summary);
  write_voxels(mapper.map(), output, {"level, z = 0 on the ground of the first local map"});
  return summary;
}

}  // namespace kissmap
