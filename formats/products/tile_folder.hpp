// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>

#include "kissmap/formats/cloud_writer.hpp"

namespace kissmap {

/// A cloud to be cut into tiles.
struct TiledCloud {
  std::uint64_t size = 0;
  std::function<CloudPoint(std::uint64_t)> point;
};

/// Throws Error(output) unless a folder of tiles may be written to `path`: nothing is there, or
/// with `overwrite` a folder that holds nothing but tiles.
void require_tile_target(const std::filesystem::path& path, bool overwrite);

/// Writes tile_X_Y.pcd for each square of `tile_size` metres that holds points, where X and Y are
/// its lower corner less the offset, and pointcloud_map_metadata.yaml as Autoware's map loader
/// reads it: corners are whole numbers there. A point on a border belongs to the higher tile. The
/// folder appears whole or not at all. Returns the number of tiles. Throws Error(output).
std::uint64_t write_tile_folder(const std::filesystem::path& path,
                                const TiledCloud& cloud,
                                int tile_size,
                                const CloudWriterOptions& options,
                                bool overwrite);

}  // namespace kissmap
