// SPDX-License-Identifier: MIT
#pragma once

#include <memory>
#include <vector>

#include "kissmap/formats/scan_log.hpp"

namespace kissmap {

/// The same log, guarded: its files must be `expected`. Names and sizes are compared at once,
/// content hashes some scans after a file has been read, and all of them at the end.
/// Throws Error(input) naming the first file that differs.
std::unique_ptr<ScanLog> verify_log(std::unique_ptr<ScanLog> log, std::vector<LogFile> expected);

}  // namespace kissmap
