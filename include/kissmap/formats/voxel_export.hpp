// SPDX-License-Identifier: MIT
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <filesystem>

#include "kissmap/formats/export_progress.hpp"
#include "kissmap/formats/product_frame.hpp"
#include "kissmap/formats/session.hpp"
#include "kissmap/geometry/rigid3.hpp"
#include "kissmap/parallel/thread_pool.hpp"

namespace kissmap {

/// What of a session becomes a 3D occupancy map, and how.
struct VoxelExportOptions {
  double min_range = 0.0;    ///< m; nearer returns are left out
  double max_range = 100.0;  ///< m; farther ones, too
  double resolution = 0.0;   ///< m, 0.01..10; 0: 0.05 where things are near, else 0.2
  double threshold = 0.5;    ///< a voxel is occupied above this probability, 0.12..0.97
  /// m, 0..1000; rays of which nothing came back are free up to here, where the log tells them
  double no_return_range = 0.0;
  ProductFrame frame = ProductFrame::level;
  std::uint64_t max_memory = 4'000'000'000;  ///< bytes of the map rays are cast into
  bool overwrite = false;
  std::filesystem::path moved_log;  ///< where the log is now, if it moved
};

struct VoxelExportSummary {
  double resolution = 0.0;         ///< m
  std::uint64_t occupied = 0;      ///< voxels
  std::uint64_t free = 0;          ///< voxels
  double area = 0.0;               ///< m2 seen from above, in squares of 8 voxels
  std::uint64_t scans = 0;         ///< whose rays were cast
  std::uint64_t rays = 0;          ///< all that were cast or skipped
  std::uint64_t skipped_rays = 0;  ///< not finite, or too far for any map
  std::uint64_t no_returns = 0;    ///< of the rays; 0 without no_return_range
  std::uint64_t memory = 0;        ///< bytes of all parts of the map when they were complete
  std::uint64_t peak_memory = 0;   ///< bytes of the map at most
  std::uint64_t passes = 0;        ///< over the log
  Rigid3 frame_from_map;           ///< the file's frame from that of the session's trajectory
  Eigen::Vector3d offset = Eigen::Vector3d::Zero();  ///< that .pcd and .ply coordinates lack [m]
  std::filesystem::path offset_file;                 ///< where it was written; empty if it is zero
};

/// Casts the rays of a session's scans, each from where the sensor was, and writes the voxels by
/// the ending of `output`: .bt or .ot (OctoMap), .vdb (OpenVDB), .pcd or .ply (centres of occupied
/// voxels with their probability as intensity). The same bytes on every run and for any number of
/// threads; the same voxels for any max_memory, from as many passes over the log as it takes.
/// Beyond that memory grows with the file, see open_voxel_writer(). Throws Error(usage) for options
/// out of range, other endings and voxels beyond OctoMap's reach; Error(input) as SessionReplay
/// does; Error(output) naming the file where it is there without `overwrite` or cannot be written.
VoxelExportSummary export_voxels(const Session& session,
                                 const std::filesystem::path& output,
                                 const VoxelExportOptions& options,
                                 ThreadPool& pool,
                                 const ExportProgress& progress);

}  // namespace kissmap
