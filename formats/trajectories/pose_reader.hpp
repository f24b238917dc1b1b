// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string_view>

#include "kissmap/geometry/rigid3.hpp"

namespace kissmap {

enum class PoseLayout { tum, kitti, euroc };

/// What the first line with numbers looks like; nothing if like none of them.
std::optional<PoseLayout> layout_of(std::string_view line);

const char* name_of(PoseLayout layout);

struct PoseRow {
  std::optional<std::int64_t> stamp_ns;  ///< none in KITTI's layout
  Rigid3 pose;
};

/// Throws std::invalid_argument that says what is wrong with the line and what to do.
PoseRow read_pose_row(std::string_view line, PoseLayout layout);

}  // namespace kissmap
