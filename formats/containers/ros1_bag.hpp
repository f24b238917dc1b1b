// SPDX-License-Identifier: MIT
#pragma once

#include <filesystem>
#include <memory>

#include "formats/containers/message_source.hpp"

namespace kissmap {

/// A ROS 1 bag, version 2.0. Layout: "Bag File Format 2.0", wiki.ros.org/Bags/Format/2.0.
/// Without an index, as a recorder leaves it that was killed, the file is looked through once.
/// Throws Error(input) for what is no such bag, is encrypted or of version 1.
std::unique_ptr<MessageSource> open_ros1_bag(const std::filesystem::path& path);

}  // namespace kissmap
