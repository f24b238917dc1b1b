// SPDX-License-Identifier: MIT
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "kissmap/formats/scan_log.hpp"

namespace kissmap {

/// A log in memory: entry i comes from file i, which counts as read once the entry was handed out.
class FakeLog : public ScanLog {
 public:
  FakeLog(std::vector<LogEntry> entries, std::vector<LogFile> files)
      : entries_(std::move(entries)), files_(std::move(files)) {
    info_.format = "fake";
    info_.path = "fake_log";
    info_.scan_count = entries_.size();
    info_.stamp_source = "index";
  }

  const LogInfo& info() const override { return info_; }

  std::optional<LogEntry> next() override {
    if (next_ >= entries_.size()) return std::nullopt;
    return entries_[next_++];
  }

  std::vector<LogFile> files() const override {
    std::vector<LogFile> files = files_;
    for (std::size_t i = next_; i < files.size(); ++i) files[i].xxh3.clear();
    return files;
  }

 private:
  LogInfo info_;
  std::vector<LogEntry> entries_;
  std::vector<LogFile> files_;
  std::size_t next_ = 0;
};

}  // namespace kissmap
