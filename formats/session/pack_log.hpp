// SPDX-License-Identifier: MIT
#pragma once

#include <filesystem>
#include <memory>

#include "kissmap/formats/scan_log.hpp"

namespace kissmap {

/// Name of the format in the list of log formats.
inline constexpr const char* packed_format_name = "packed";

/// True for a .kmpack file and for a session folder with one inside. Never throws.
bool probe_packed(const std::filesystem::path& path);

/// Opens the scans PackWriter stored. A scan whose bytes are damaged is a RefusedScan; a pack that
/// was never finished, is cut off or has a damaged frame header is an Error(input). Read options
/// change nothing: what they choose was chosen when the pack was made.
std::unique_ptr<ScanLog> open_packed(const std::filesystem::path& path, const ReadOptions& options);

}  // namespace kissmap
