// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <variant>
#include <vector>

#include "formats/clouds/record_layout.hpp"

namespace kissmap {

inline constexpr int min_bin_columns = 3;
inline constexpr int max_bin_columns = 64;

/// Reads a headerless file of little-endian float32 rows: x y z, then intensity (4 columns: KITTI),
/// ring (5: nuScenes), laser and time (6: Boreas); further columns are passed over. Layouts:
/// KITTI's odometry development kit, data_classes.py of nuscenes-devkit, DATA_REFERENCE.md of
/// pyboreas.
/// Throws Refusal when the size is no multiple of the row. The records point into `file`.
PointRecords read_bin(std::span<const std::byte> file, int columns);

/// The number of columns that fits a log: 4, 5 or 6, if its rows alone divide every size and the
/// coordinates of `sample`, a whole file, are finite and below 1 km. Otherwise what is in the way.
std::variant<int, std::string> infer_bin_columns(const std::vector<std::uint64_t>& sizes,
                                                 std::span<const std::byte> sample);

}  // namespace kissmap
