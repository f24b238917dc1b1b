// SPDX-License-Identifier: MIT
#include "kissmap/formats/voxel_export.hpp"

#include <sstream>
#include <unordered_set>

#include "formats/products/cast_in_parts.hpp"
#include "formats/products/cloud_frame.hpp"
#include "formats/products/export_target.hpp"
#include "formats/products/offset_file.hpp"
#include "formats/products/resolution.hpp"
#include "formats/voxels/voxel_writer.hpp"
#include "kissmap/error.hpp"
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

double resolution_of(const VoxelExportOptions& options, const Session& session) {
  if (options.resolution != 0.0) return options.resolution;
  return fitting_resolution(session, options.min_range, options.max_range, options.moved_log).voxel;
}

/// Told before hours of work; what the rays reach beyond the path is known afterwards only.
void require_octomap_reach(const Session& session, const fs::path& output, double resolution) {
  const auto format = voxel_format(output);
  if (format != VoxelFormat::octomap_binary && format != VoxelFormat::octomap_full) return;
  double farthest = 0.0;
  for (const SessionScan& scan : session.scans) {
    farthest = std::max(farthest, scan.mapped.map_from_lidar.translation.cwiseAbs().maxCoeff());
  }
  const double reach = 32768.0 * resolution;
  if (farthest < reach) return;
  std::ostringstream message;
  message << output.string() << ": the path goes " << farthest << " m from the origin, OctoMap "
          << reach << " m with voxels of " << resolution
          << " m; take a coarser --resolution, or write .vdb";
  throw usage_error(message.str());
}

VoxelWriterOptions file_options(const Session& session,
                                const fs::path& output,
                                const VoxelExportOptions& options,
                                double resolution) {
  VoxelWriterOptions file;
  file.geometry.voxel_size.setConstant(resolution);
  file.log_odds.occupied_probability = options.threshold;
  file.frame = name_of(options.frame);
  if (voxel_format(output) == VoxelFormat::cloud) {
    file.offset = single_precision_offset(reach_of(session, options.max_range));
  }
  return file;
}

void count_voxels(const OccupancyMap& part, VoxelExportSummary& summary) {
  std::unordered_set<VoxelKey> columns;
  part.for_each_block([&](const OccupancyBlock& block) {
    columns.insert(voxel_key({block.first.x, block.first.y, 0}));
    for (const LogOdds value : block.values) {
      summary.occupied += part.steps().is_occupied(value) ? 1 : 0;
      summary.free += part.steps().is_free(value) ? 1 : 0;
    }
  });
  const double side = occupancy_block_side * part.geometry().voxel_size.x();
  summary.area += static_cast<double>(columns.size()) * side * side;
  summary.memory += part.memory_bytes();
}

}  // namespace

VoxelExportSummary export_voxels(const Session& session_in_map,
                                 const fs::path& output,
                                 const VoxelExportOptions& options,
                                 ThreadPool& pool,
                                 const ExportProgress& progress) {
  require_options(options);
  if (!voxel_format(output)) throw wrong_voxel_ending(output);
  require_file_target(output, options.overwrite);
  VoxelExportSummary summary;
  summary.frame_from_map = frame_from_map(session_in_map, options.frame);
  const Session session = moved(session_in_map, summary.frame_from_map);
  summary.resolution = resolution_of(options, session);
  require_octomap_reach(session, output, summary.resolution);

  const VoxelWriterOptions file = file_options(session, output, options, summary.resolution);
  VoxelMapperOptions mapping;
  mapping.occupancy.log_odds = file.log_odds;
  mapping.no_return_range = options.no_return_range;
  VoxelMapper mapper(file.geometry, mapping);
  const auto cast = [&](const PlacedScan& scan) {
    const OccupancyUpdate update = mapper.add(scan, pool);
    if (summary.passes > 0) return;  // counted in the first pass
    ++summary.scans;
    summary.rays += update.rays;
    summary.skipped_rays += update.non_finite + update.too_far;
  };
  const auto writer = open_voxel_writer(output, file);
  const auto write = [&] {
    ++summary.passes;
    count_voxels(mapper.map(), summary);
    writer->add(mapper.map());
  };
  const CastSummary parts = cast_in_parts(session,
                                          {options.min_range,
                                           options.max_range,
                                           options.moved_log,
                                           options.max_memory,
                                           options.no_return_range > 0.0},
                                          {&mapper.map()},
                                          progress,
                                          cast,
                                          write);
  summary.peak_memory = parts.peak_memory;
  summary.no_returns = parts.no_returns;
  summary.offset = file.offset;
  summary.offset_file = write_offset_file(output, file.offset);
  writer->finish();
  return summary;
}

}  // namespace kissmap
