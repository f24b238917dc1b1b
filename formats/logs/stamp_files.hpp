// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "kissmap/formats/scan_log.hpp"

namespace kissmap {

/// Stamps read from a text file; a blank line stands for a missing scan.
struct StampFile {
  std::vector<std::optional<std::int64_t>> stamps_ns;
  LogFile file;
};

/// One number a line: seconds, or whole numbers of 13, 16 or 19 digits (ms, us, ns since 1970).
/// Lines that begin with # are comments; blank lines are allowed at the end only.
/// Throws Error(input) naming the line.
StampFile read_number_stamps(const std::filesystem::path& path, const std::string& name);

/// One "YYYY-MM-DD HH:MM:SS.fraction" a line, or a blank line. Throws Error(input).
StampFile read_date_stamps(const std::filesystem::path& path, const std::string& name);

}  // namespace kissmap
