// SPDX-License-Identifier: MIT
#include "formats/voxels/voxel_writer.hpp"

#include "formats/text/lower_case.hpp"
#include "formats/voxels/voxel_files.hpp"

namespace kissmap {

std::optional<VoxelFormat> voxel_format(const std::filesystem::path& path) {
  const std::string ending = lower_case(path.extension().string());
  if (ending == ".bt") return VoxelFormat::octomap_binary;
  if (ending == ".ot") return VoxelFormat::octomap_full;
  if (ending == ".vdb") return VoxelFormat::openvdb;
  if (ending == ".pcd" || ending == ".ply") return VoxelFormat::cloud;
  return std::nullopt;
}

Error wrong_voxel_ending(const std::filesystem::path& path) {
  return usage_error(path.string() + ": voxels are written to .bt, .ot, .vdb, .pcd or .ply");
}

std::unique_ptr<VoxelWriter> open_voxel_writer(const std::filesystem::path& path,
                                               const VoxelWriterOptions& options) {
  const std::optional<VoxelFormat> format = voxel_format(path);
  if (!format) throw wrong_voxel_ending(path);
  if (*format == VoxelFormat::openvdb) return open_vdb_writer(path, options);
  if (*format == VoxelFormat::cloud) return open_voxel_cloud_writer(path, options);
  return open_octree_writer(path, options, *format == VoxelFormat::octomap_binary);
}

}  // namespace kissmap
