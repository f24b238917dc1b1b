// SPDX-License-Identifier: MIT
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>

#include "kissmap/error.hpp"
#include "kissmap/occupancy/occupancy_map.hpp"

namespace kissmap {

enum class VoxelFormat : std::uint8_t { octomap_binary, octomap_full, openvdb, cloud };

/// By the ending of a name, in upper or lower case: .bt, .ot, .vdb, .pcd and .ply; nothing for
/// others.
std::optional<VoxelFormat> voxel_format(const std::filesystem::path& path);

/// Error(usage) that names the endings.
Error wrong_voxel_ending(const std::filesystem::path& path);

struct VoxelWriterOptions {
  OccupancyGeometry geometry;  ///< of all parts
  LogOddsOptions log_odds;     ///< of all parts; occupied is what they say
  std::string frame = "map";   ///< noted in the file where its format has a place for it
  /// m, what coordinates in .pcd and .ply are relative to, which hold single precision
  Eigen::Vector3d offset = Eigen::Vector3d::Zero();
};

/// A file that appears when it is finished, in place of whatever had its name, or not at all.
class VoxelWriter {
 public:
  virtual ~VoxelWriter() = default;
  /// Parts share no block. Throws Error(usage) where a voxel lies beyond OctoMap's reach.
  virtual void add(const OccupancyMap& part) = 0;
  virtual void finish() = 0;
};

/// By the ending of `path`:
/// .bt   OctoMap, occupied or free for each known voxel
/// .ot   OctoMap, log-odds of each known voxel
/// .vdb  OpenVDB, FloatGrid "occupancy": log-odds, background 0, active where known; index (i,j,k)
///       lies at the centre of voxel (i,j,k)
/// .pcd, .ply  centres of occupied voxels, their probability as intensity
/// Same parts, same bytes; for trees also if the same voxels came in other parts. The file
/// is kept in memory until the end: for OctoMap its bytes and 40 for each block of 8^3 voxels, for
/// OpenVDB its tree, 2.1 kB a block or next to nothing where all voxels hold the same belief.
/// Throws Error(usage) for other endings and, for OctoMap, where voxels are not cubes that begin at
/// 0; Error(output) naming the file, as the writer does.
std::unique_ptr<VoxelWriter> open_voxel_writer(const std::filesystem::path& path,
                                               const VoxelWriterOptions& options);

}  // namespace kissmap
