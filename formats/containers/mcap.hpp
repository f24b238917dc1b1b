// SPDX-License-Identifier: MIT
#pragma once

#include <filesystem>
#include <memory>

#include "formats/containers/message_source.hpp"

namespace kissmap {

/// An MCAP file with messages of ROS 1, ROS 2 (CDR) or protobuf. Layout: the MCAP specification,
/// mcap.dev/spec. Without a summary, or where it is damaged, the file is looked through once.
/// Throws Error(input) for what is no MCAP file.
std::unique_ptr<MessageSource> open_mcap(const std::filesystem::path& path);

}  // namespace kissmap
