// SPDX-License-Identifier: MIT
#pragma once

#include "formats/voxels/voxel_writer.hpp"

namespace kissmap {

/// One function a format; see open_voxel_writer().
std::unique_ptr<VoxelWriter> open_octree_writer(const std::filesystem::path& path,
                                                const VoxelWriterOptions& options,
                                                bool binary);
std::unique_ptr<VoxelWriter> open_vdb_writer(const std::filesystem::path& path,
                                             const VoxelWriterOptions& options);
std::unique_ptr<VoxelWriter> open_voxel_cloud_writer(const std::filesystem::path& path,
                                                     const VoxelWriterOptions& options);

}  // namespace kissmap
