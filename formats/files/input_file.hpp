// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <vector>

namespace kissmap {

/// A bigger file is no single scan.
inline constexpr std::uint64_t max_file_bytes = std::uint64_t{2} << 30;

/// Reads a whole file into `buffer`, whose memory is reused. Throws Refusal when that fails or the
/// file is larger than max_file_bytes.
void read_file(const std::filesystem::path& path, std::vector<std::byte>& buffer);

/// The content of a file that a log cannot do without. Throws Error, which names the file.
std::vector<std::byte> read_side_file(const std::filesystem::path& path);

/// Up to `count` bytes from the front of a file; fewer or none if it cannot be read. Never throws.
std::vector<std::byte> first_bytes(const std::filesystem::path& path, std::size_t count) noexcept;

}  // namespace kissmap
