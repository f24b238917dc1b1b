// SPDX-License-Identifier: MIT
#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <string>
#include <vector>

#include "kissmap/formats/pictures.hpp"
#include "kissmap/grid/grid_map.hpp"

namespace kissmap {

/// How a map server is to read the cells: three values, or graded from free to occupied.
enum class GridMode : std::uint8_t { trinary, scale };

/// Writes STEM.yaml and the image it names, as map_server (ROS 1) and nav2 read them: the top row
/// is the highest y, the origin is the outer corner of the lower left cell, yaw 0, negate 0,
/// occupied_thresh 0.65, free_thresh 0.196 (205 must not read as free).
/// - trinary: STEM.pgm (binary, 8 bits): 0 occupied, 254 free, 205 unknown;
/// - scale: STEM.png (grey and alpha): 255 * (1 - probability), alpha 0 where unknown.
/// `comments` go into the YAML, a line each. Both are written aside; the image is renamed first, so
/// that a YAML never names an image that is not there. Throws Error(output), also for a map without
/// cells.
void write_grid(const GridMap& map,
                GridMode mode,
                const std::filesystem::path& stem,
                const std::vector<std::string>& comments = {});

/// A YAML string in double quotes.
std::string yaml_quoted(const std::string& text);

/// The files write_grid() would write: image, then YAML.
std::vector<std::filesystem::path> grid_file_paths(const std::filesystem::path& stem,
                                                   GridMode mode);

/// A stretch of a trajectory from above [m].
using PlanPath = std::vector<Eigen::Vector2d>;

/// The map for people: with the stretches of the trajectory, each drawn for itself, from the start
/// of the first (green) to the end of the last (red), and a scale bar. Cells are enlarged if the
/// map is small; halved where its longer side exceeds `max_pixels`.
Picture draw_grid(const GridMap& map,
                  const std::vector<PlanPath>& stretches,
                  int max_pixels = 2000);

}  // namespace kissmap
