// SPDX-License-Identifier: MIT
#pragma once

#include <filesystem>
#include <functional>
#include <memory>

#include "formats/containers/message_source.hpp"

namespace kissmap {

/// Unpacks a zstd file into the folder for temporary files (TMPDIR), under its name without the
/// last extension, and opens that. The unpacked file goes when the source does.
/// A broken or cut stream gives what came before, and damage. Throws Error(input) where nothing
/// can be unpacked, Error(output) where there is no room.
std::unique_ptr<MessageSource> open_unpacked(
    const std::filesystem::path& packed,
    const std::function<std::unique_ptr<MessageSource>(const std::filesystem::path&)>& open);

}  // namespace kissmap
