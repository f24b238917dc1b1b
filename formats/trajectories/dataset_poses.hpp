// SPDX-License-Identifier: MIT
#pragma once

#include "formats/trajectories/pose_fields.hpp"
#include "formats/trajectories/pose_reader.hpp"

namespace kissmap {

inline constexpr std::size_t apollo_columns = 9;

/// The layout of a data set's ground truth, by its fields between commas.
std::optional<PoseLayout> dataset_layout(const Fields& fields);

/// Sources of the layouts, and of the mounts that take them to the LiDAR: see the .cpp.
PoseRow dataset_row(const Fields& fields, PoseLayout layout);

}  // namespace kissmap
