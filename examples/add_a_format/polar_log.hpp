// SPDX-License-Identifier: MIT
#pragma once

#include <filesystem>
#include <memory>

#include "kissmap/formats/scan_log.hpp"

namespace kissmap {

/// True for a folder of scans named by their stamp, such as 1700000000100000.polar. Never throws.
bool probe_polar(const std::filesystem::path& path);

/// Opens such a folder. Throws Error(input) where there is none.
std::unique_ptr<ScanLog> open_polar(const std::filesystem::path& path, const ReadOptions& options);

}  // namespace kissmap
