// SPDX-License-Identifier: MIT
#pragma once

#include "formats/voxels/voxel_writer.hpp"

namespace kissmap {

/// One function a format; see write_voxels().
void write_octree(const OccupancyMap& map, bool binary, const std::filesystem::path& path);
void write_vdb(const OccupancyMap& map,
               const std::filesystem::path& path,
               const VoxelWriterOptions& options);
void write_voxel_cloud(const OccupancyMap& map,
                       const std::filesystem::path& path,
                       const VoxelWriterOptions& options);

}  // namespace kissmap
