// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <filesystem>

#include "kissmap/formats/export_progress.hpp"
#include "kissmap/formats/session.hpp"
#include "kissmap/geometry/rigid3.hpp"
#include "kissmap/parallel/thread_pool.hpp"

namespace kissmap {

/// What of a session becomes a 3D occupancy map, and how.
struct VoxelExportOptions {
  double min_range = 0.0;    ///< m; nearer returns are left out
  double max_range = 100.0;  ///< m; farther ones, too
  double resolution = 0.0;   ///< m, 0.01..10; 0: 0.05, 0.1 or 0.2 by how near things are
  double threshold = 0.5;    ///< a voxel is occupied above this probability, 0.12..0.97
  /// m, 0..1000; rays of which nothing came back are free up to here, where the log tells them
  double no_return_range = 0.0;
  bool overwrite = false;
  std::filesystem::path moved_log;  ///< where the log is now, if it moved
};

struct VoxelExportSummary {
  double resolution = 0.0;         ///< m
  std::uint64_t occupied = 0;      ///< voxels
  std::uint64_t free = 0;          ///< voxels
  std::uint64_t scans = 0;         ///< whose rays were cast
  std::uint64_t rays = 0;          ///< all that were cast or skipped
  std::uint64_t skipped_rays = 0;  ///< not finite, or too far for any map
  std::size_t memory_bytes = 0;    ///< of the map
  Rigid3 level_from_map;           ///< the file's frame from that of the session's trajectory
};

/// Casts the rays of a session's scans, each from where the sensor was, and writes the voxels by
/// the ending of `output`: .bt or .ot (OctoMap), .vdb (OpenVDB), .pcd or .ply (centres of occupied
/// voxels with their probability as intensity). Frame: that of the session, levelled by
/// level_from_map(), as the maps of export_grid() are. The same bytes on every run and for any
/// number of threads. Reads the log once, twice to choose a resolution. Memory grows with the
/// volume seen, see OccupancyMap, and with the file. Throws Error(usage) for options out of range,
/// other endings and voxels beyond OctoMap's reach; Error(input) as SessionReplay does;
/// Error(output) naming the file where it is there without `overwrite` or cannot be written.
VoxelExportSummary export_voxels(const Session& session,
                                 const std::filesystem::path& output,
                                 const VoxelExportOptions& options,
                                 ThreadPool& pool,
                                 const ExportProgress& progress);

}  // namespace kissmap
