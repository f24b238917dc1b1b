// SPDX-License-Identifier: MIT
#pragma once

#include <filesystem>
#include <memory>
#include <span>
#include <string>

#include "kissmap/formats/scan_log.hpp"

namespace kissmap {

/// A kind of log kissmap reads.
struct LogFormat {
  const char* name;         ///< for --format
  const char* description;  ///< one line for `kissmap formats`
  const char* layout;       ///< what PATH must look like, one line
  /// Looks at names and first bytes. Never throws; false for anything else.
  bool (*probe)(const std::filesystem::path& path);
  /// Throws Error(input) naming file, place and cure.
  std::unique_ptr<ScanLog> (*open)(const std::filesystem::path& path, const ReadOptions& options);
};

/// All formats, in the order in which they are shown.
std::span<const LogFormat> log_formats();

/// Opens a log. With an empty format name, the one format whose probe agrees is used; none or
/// several is an Error(input) that lists the candidates. Unknown names are an Error(usage).
std::unique_ptr<ScanLog> open_log(const std::filesystem::path& path,
                                  const ReadOptions& options = {},
                                  const std::string& format_name = {});

}  // namespace kissmap
