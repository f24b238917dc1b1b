// SPDX-License-Identifier: MIT
#pragma once

#include <filesystem>
#include <memory>

#include "formats/containers/message_source.hpp"

namespace kissmap {

/// True for names a ROS 2 bag gives its files: .db3, .mcap, each also with .zstd.
bool is_ros2_bag_file(const std::filesystem::path& path);

/// A ROS 2 bag: its folder, with metadata.yaml or without, or one of its files. Files packed as a
/// whole are unpacked into the folder for temporary files while the log is open.
/// Layout: ros2/rosbag2, rosbag2_storage and rosbag2_compression.
/// Throws Error(input), and Error(output) where there is no room to unpack a file.
std::unique_ptr<MessageSource> open_ros2_bag(const std::filesystem::path& path);

}  // namespace kissmap
