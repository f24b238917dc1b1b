// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <span>
#include <string>

#include "formats/clouds/record_layout.hpp"

namespace kissmap {

/// The encodings of a file that holds one cloud.
enum class CloudKind { pcd, ply, bin, npy, text, las };

/// By the end of the name, in upper or lower case: .pcd, .ply, .bin, .npy, .las, .xyz, and .csv
/// where the name ends in a digit before that, as tables beside clouds do not.
std::optional<CloudKind> kind_by_name(const std::filesystem::path& path);

/// What the first bytes of a file say it is, in words: "PCD", "PLY", or something that is no cloud
/// ("ROS 1 bag", "gzip archive" ...). Nothing for bytes without a mark, such as a .bin.
std::optional<std::string> kind_by_content(std::span<const std::byte> first_bytes);

/// How many bytes kind_by_content wants to see.
inline constexpr std::size_t probe_size = 4096;

/// Reads a file of the given kind; `bin_columns` counts for .bin alone. Throws Refusal, also when
/// the content is not what the kind says.
PointRecords read_cloud(std::span<const std::byte> file, CloudKind kind, int bin_columns);

}  // namespace kissmap
