// SPDX-License-Identifier: MIT
#pragma once

#include <string>

#include "kissmap/formats/scan_log.hpp"

namespace kissmap {

/// Reads some scans after the first and tells their rate and size in a line; empty where there are
/// none. What they are is not known of the rest of the log.
std::string describe_sample(ScanLog& log, const LogEntry& first);

/// ", 10.00 scans a second"; empty where nothing tells.
std::string describe_rate(std::size_t scans, double seconds);

}  // namespace kissmap
