// SPDX-License-Identifier: MIT
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <filesystem>
#include <vector>

#include "kissmap/loop_closing/closure.hpp"
#include "kissmap/mapping/local_map.hpp"

namespace kissmap {

/// 8-bit RGB image, row 0 on top.
struct Picture {
  int width = 0;
  int height = 0;
  std::vector<std::uint8_t> rgb;  ///< width * height * 3
};

/// Writes aside, then renames. Throws Error(output).
void write_png(const Picture& picture, const std::filesystem::path& path);

/// The map of a session from above, x to the right and y up, coloured by height, with the
/// trajectory, its start and end, closures between keyposes (accepted green, refused red), and a
/// scale bar in metres. Reads the local maps one by one.
/// The longer side has at most `max_pixels` pixels.
Picture draw_map_from_above(const std::filesystem::path& session_folder, int max_pixels = 2000);

/// What the tables of a session say of its map.
struct MapLayout {
  std::vector<LocalMap> local_maps;  ///< with their keyposes; surfels are not looked at
  std::vector<Eigen::Vector3d> trajectory;
  std::vector<Closure> closures;
};

/// The same picture for other poses than those in the tables: only the surfels are read.
Picture draw_map_from_above(const std::filesystem::path& session_folder,
                            const MapLayout& layout,
                            int max_pixels = 2000);

}  // namespace kissmap
