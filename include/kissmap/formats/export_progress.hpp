// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <functional>

namespace kissmap {

/// What is being done, for people: "reading scans", 3 of 100.
using ExportProgress = std::function<void(const char* what, std::uint64_t done, std::uint64_t of)>;

}  // namespace kissmap
