// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <vector>

#include "formats/trajectories/pose_fields.hpp"
#include "formats/trajectories/pose_reader.hpp"

namespace kissmap {

inline constexpr std::size_t apollo_columns = 9;

/// The layout of a data set's ground truth, by its fields between commas.
std::optional<PoseLayout> dataset_layout(const Fields& fields);

/// Paris-Luco has no stamps but those that follow from the number of a frame.
inline constexpr std::int64_t paris_luco_period_ns = 100'000'000;
inline constexpr const char* paris_luco_truth = "gt_traj_lidar.txt";

/// Stamps [ns] of its truth: row k holds for the middle of frame k's sweep, which begins at k
/// periods, as CT-ICP's evaluation and MOLA take it.
std::vector<std::int64_t> paris_luco_stamps(std::size_t rows);

/// Where MulRan's Ouster sits on the vehicle (Kim et al., ICRA 2020).
Rigid3 mulran_base_from_lidar();

/// Sources of the layouts, and of the mounts that take them to the LiDAR: see the .cpp.
PoseRow dataset_row(const Fields& fields, PoseLayout layout);

}  // namespace kissmap
