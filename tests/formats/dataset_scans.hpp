// SPDX-License-Identifier: MIT
// Scans of a data set that has to be recognised.
#pragma once

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "formats/support.hpp"

namespace kissmap::test {

inline std::vector<LogEntry> entries_of(const fs::path& path, const std::string& format) {
  const auto log = open_log(path);
  EXPECT_EQ(log->info().format, format);
  return read_all(*log);
}

inline Scan only_scan(const fs::path& path, const std::string& format) {
  const auto entries = entries_of(path, format);
  if (entries.size() != 1) throw std::runtime_error(std::to_string(entries.size()) + " scans");
  return scan_of(entries[0]);
}

}  // namespace kissmap::test
