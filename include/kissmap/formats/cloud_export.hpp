// SPDX-License-Identifier: MIT
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <filesystem>
#include <vector>

#include "kissmap/cloud/crop_region.hpp"
#include "kissmap/formats/cloud_writer.hpp"
#include "kissmap/formats/export_progress.hpp"
#include "kissmap/formats/product_frame.hpp"
#include "kissmap/formats/session.hpp"
#include "kissmap/parallel/thread_pool.hpp"

namespace kissmap {

/// What of a session becomes a cloud, and how.
struct CloudExportOptions {
  double min_range = 0.0;    ///< m; nearer returns are left out
  double max_range = 100.0;  ///< m; farther ones, too
  double voxel_size = 0.1;   ///< m, see ThinnedCloud; 0 keeps every point
  ProductFrame frame = ProductFrame::level;
  CropRegion crop;                 ///< in that frame, before thinning
  CloudFields fields;              ///< rgb: coloured by height, as in the session's picture
  bool intensity_if_there = true;  ///< adds the intensity where the log has one
  bool remove_outliers = false;    ///< see find_inliers; wants voxel_size > 0, as normals do
  bool remove_dynamic = false;     ///< what moved, see MovedReturns
  bool compress = false;           ///< PCD only
  int tile_size = 0;  ///< m; > 0 writes a folder of tiles instead of a file, wants voxel_size > 0
  bool overwrite = false;
  std::filesystem::path moved_log;  ///< where the log is now, if it moved
};

struct CloudExportSummary {
  std::uint64_t points_inside = 0;   ///< replayed, within the ranges and the crop
  std::uint64_t moved_points = 0;    ///< of these, of what moved: not in the cloud
  std::filesystem::path moved_file;  ///< the cloud they are in; empty if they are not to be removed
  std::uint64_t outliers = 0;        ///< voxels whose point was left out
  std::uint64_t points_written = 0;
  std::uint64_t tiles = 0;
  Rigid3 frame_from_map;  ///< where the cloud lies beside trajectory.tum
  CloudFields fields;
  Eigen::Vector3d offset = Eigen::Vector3d::Zero();  ///< that PCD and PLY coordinates lack [m]
  std::filesystem::path offset_file;                 ///< where it was written; empty if it is zero
};

/// Writes the points of a session, each where the final trajectory puts it, to `output`: a .pcd,
/// .ply or .las file, or with tile_size a folder of .pcd tiles and the metadata that Autoware's map
/// loader reads. Points are in the order of their scans, voxels in that of their first points: the
/// same bytes on every run and for any number of threads. Memory is bounded by the map, or without
/// thinning by a few scans. With remove_dynamic the log is read twice before, and points of what
/// moved go into a cloud of their own, OUTPUT_removed, with the same fields but normals.
/// PCD and PLY coordinates are relative to `offset`, which is zero while the map is within 8192 m
/// of its origin; beyond, a file OUTPUT.offset.txt (offset.txt among tiles) says what to add.
/// Throws Error(usage) for options that exclude each other, for fields the log cannot give and
/// where no point is left; Error(input) as SessionReplay does; Error(output) naming the file. What
/// was begun is removed then.
CloudExportSummary export_cloud(const Session& session,
                                const std::filesystem::path& output,
                                const CloudExportOptions& options,
                                ThreadPool& pool,
                                const ExportProgress& progress);

/// Corners of a polygon from a text file: one `x y` [m] a line, '#' begins a remark, a
/// comma may separate. Throws Error(input) naming the line.
std::vector<Eigen::Vector2d> read_polygon(const std::filesystem::path& path);

}  // namespace kissmap
