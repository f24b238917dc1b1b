// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string_view>

#include "kissmap/geometry/rigid3.hpp"

namespace kissmap {

enum class PoseLayout {
  tum,
  kitti,
  euroc,
  mulran,
  boreas,
  nclt,
  newer_college,
  spires,
  apollo,
  positions
};

/// What the first line with numbers looks like; nothing if like none of them.
std::optional<PoseLayout> layout_of(std::string_view line);

const char* name_of(PoseLayout layout);

struct PoseRow {
  std::optional<std::int64_t> stamp_ns;  ///< none in KITTI's layout
  Rigid3 pose;
};

/// Throws std::invalid_argument that says what is wrong with the line and what to do. Data sets'
/// own layouts give the pose of the LiDAR where the mount is the same for all of the data set.
PoseRow read_pose_row(std::string_view line, PoseLayout layout);

/// True for the line of column names some layouts begin with.
bool is_column_names(std::string_view line);

/// True for rows of layouts that begin before the first pose is known.
bool is_unknown_pose(std::string_view line, PoseLayout layout);

}  // namespace kissmap
