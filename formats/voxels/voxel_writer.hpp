// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <filesystem>
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
  std::string frame = "map";  ///< noted in the file where its format has a place for it
};

/// Replaces whatever file `path` is; it appears whole or not at all. By the ending of `path`:
/// .bt   OctoMap, occupied or free for each known voxel
/// .ot   OctoMap, log-odds of each known voxel
/// .vdb  OpenVDB, FloatGrid "occupancy": log-odds, background 0, active where known; index (i,j,k)
///       lies at the centre of voxel (i,j,k)
/// .pcd, .ply  centres of occupied voxels, their probability as intensity
/// Occupied is what map.steps() says. Same map, same bytes. Takes memory for the file and for a
/// tree of 16 to 80 bytes a node, cloud files for neither.
/// Throws Error(usage) for other endings and, for OctoMap, where a voxel lies beyond its reach of
/// 2^15 voxels or the map's voxels are not cubes that begin at 0; Error(output) naming the file.
void write_voxels(const OccupancyMap& map,
                  const std::filesystem::path& path,
                  const VoxelWriterOptions& options);

}  // namespace kissmap
