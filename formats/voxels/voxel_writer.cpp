// SPDX-License-Identifier: MIT
#include "formats/voxels/voxel_writer.hpp"

#include <algorithm>

#include "formats/voxels/voxel_files.hpp"

namespace kissmap {

std::optional<VoxelFormat> voxel_format(const std::filesystem::path& path) {
  std::string ending = path.extension().string();
  std::ranges::transform(ending, ending.begin(), [](char c) {
    return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
  });
  if (ending == ".bt") return VoxelFormat::octomap_binary;
  if (ending == ".ot") return VoxelFormat::octomap_full;
  if (ending == ".vdb") return VoxelFormat::openvdb;
  if (ending == ".pcd" || ending == ".ply") return VoxelFormat::cloud;
  return std::nullopt;
}

Error wrong_voxel_ending(const std::filesystem::path& path) {
  return usage_error(path.string() + ": voxels are written to .bt, .ot, .vdb, .pcd or .ply");
}

void write_voxels(const OccupancyMap& map,
                  const std::filesystem::path& path,
                  const VoxelWriterOptions& options) {
  const std::optional<VoxelFormat> format = voxel_format(path);
  if (!format) throw wrong_voxel_ending(path);
  switch (*format) {
    case VoxelFormat::octomap_binary:
      return write_octree(map, true, path);
    case VoxelFormat::octomap_full:
      return write_octree(map, false, path);
    case VoxelFormat::openvdb:
      return write_vdb(map, path, options);
    case VoxelFormat::cloud:
      return write_voxel_cloud(map, path, options);
  }
}

}  // namespace kissmap
