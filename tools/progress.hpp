// SPDX-License-Identifier: MIT
#pragma once

#include <chrono>
#include <cstdint>
#include <optional>
#include <string>

namespace kissmap {

/// State of a run, for people.
struct RunProgress {
  std::uint64_t scans = 0;
  std::optional<std::uint64_t> scans_expected;
  double log_seconds = 0.0;  ///< recorded time covered so far
  double distance = 0.0;     ///< m
};

/// One line on stderr that is rewritten a few times a second; silent unless stderr is a terminal.
class ProgressLine {
 public:
  explicit ProgressLine(bool enabled);
  ~ProgressLine();
  void show(const RunProgress& progress);
  void show(const std::string& state);
  double seconds() const;  ///< since construction

 private:
  using Clock = std::chrono::steady_clock;
  bool is_due() const;
  void draw(const std::string& text);

  bool enabled_;
  Clock::time_point start_ = Clock::now();
  Clock::time_point next_ = start_;
};

/// "812/1200 scans  84.3/s  8.4 x real time  612 m  0:05 left"
std::string describe(const RunProgress& progress, double seconds);

}  // namespace kissmap
