// SPDX-License-Identifier: MIT
#pragma once

#include <filesystem>
#include <memory>

#include "formats/containers/message_source.hpp"

namespace kissmap {

/// A .db3 file of a ROS 2 bag, of any of its four schemas. Layout: ros2/rosbag2,
/// rosbag2_storage_sqlite3. Messages packed one by one with zstd are unpacked. With `count` the
/// messages of each topic are counted, which reads a part of each.
/// Throws Error(input) for what is no such file.
std::unique_ptr<MessageSource> open_sqlite_bag(const std::filesystem::path& path, bool count);

}  // namespace kissmap
