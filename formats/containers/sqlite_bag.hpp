// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>

#include "formats/containers/message_source.hpp"

namespace kissmap {

/// A .db3 file of a ROS 2 bag, of any of its four schemas. Layout: ros2/rosbag2,
/// rosbag2_storage_sqlite3. Messages packed one by one with zstd are unpacked.
///
/// The messages of each topic are counted by what the recorder wrote into the file at its end, or
/// else by looking at a part of each, if that takes no more than `most_bytes_to_count` of reading.
/// Throws Error(input) for what is no such file.
std::unique_ptr<MessageSource> open_sqlite_bag(const std::filesystem::path& path,
                                               std::uint64_t most_bytes_to_count);

}  // namespace kissmap
