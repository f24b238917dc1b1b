// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <vector>

#include "support/occupancy_plan.hpp"

namespace kissmap {

/// Whose rules: map_server of ROS 1, or map_io of nav2_map_server.
enum class MapLoader { map_server, nav2 };

/// What the loader would publish, like nav_msgs/OccupancyGrid.
struct LoadedMap {
  int width = 0;
  int height = 0;
  double resolution = 0.0;         ///< m
  std::array<double, 3> origin{};  ///< m, m, rad: lower left corner, and how the map is turned
  std::vector<std::int8_t> data;   ///< -1 unknown, else 0 to 100; the row of lowest y first
};

/// Reads a map.yaml and its PGM by the rules of a loader, which are, for occ = (255 - v) / 255, or
/// v / 255 with negate:
///
/// |                 | map_server                     | nav2                          |
/// |-----------------|--------------------------------|-------------------------------|
/// | occupied (100)  | occ > occupied_thresh          | occ >= occupied_thresh        |
/// | free (0)        | occ < free_thresh              | occ <= free_thresh            |
/// | between, trinary| -1                             | -1                            |
/// | between, scale  | 1 + 98 ratio, cut off          | 100 ratio, rounded            |
/// | negate          | an integer                     | an integer or a bool          |
///
/// ratio = (occ - free_thresh) / (occupied_thresh - free_thresh). Mandatory: image (relative to the
/// YAML, or absolute), resolution, origin (three numbers), negate, occupied_thresh, free_thresh;
/// mode is trinary if absent. The top row of the image has the largest y.
///
/// Written from these rules, not from the loaders. Images are 8-bit P5 only, which has no alpha;
/// mode raw is refused, too. Throws Error(input) for these and for what the loaders refuse.
LoadedMap load_map(const std::filesystem::path& yaml, MapLoader loader);

/// The map as AMCL takes it: only 100 is occupied, only 0 is free, the origin's yaw is ignored.
OccupancyPlan as_amcl_sees(const LoadedMap& map);

}  // namespace kissmap
