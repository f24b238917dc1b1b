// SPDX-License-Identifier: MIT
#include "progress.hpp"

#include <unistd.h>

#include <cmath>
#include <cstdio>

namespace kissmap {
namespace {

constexpr std::chrono::milliseconds redraw_interval{200};

std::string format(const char* pattern, double value) {
  char text[48];
  std::snprintf(text, sizeof(text), pattern, value);
  return text;
}

std::string clock_text(double seconds) {
  const auto whole = static_cast<long>(std::ceil(seconds));
  char text[32];
  std::snprintf(text, sizeof(text), "%ld:%02ld", whole / 60, whole % 60);
  return text;
}

}  // namespace

ProgressLine::ProgressLine(bool enabled) : enabled_(enabled && isatty(STDERR_FILENO) == 1) {
}

ProgressLine::~ProgressLine() {
  if (enabled_) std::fputs("\r\033[K", stderr);
}

void ProgressLine::show(const RunProgress& progress) {
  if (is_due()) draw(describe(progress, seconds()));
}

void ProgressLine::show(const std::string& state) {
  if (is_due()) draw(state);
}

bool ProgressLine::is_due() const {
  return enabled_ && Clock::now() >= next_;
}

void ProgressLine::draw(const std::string& text) {
  next_ = Clock::now() + redraw_interval;
  std::fprintf(stderr, "\r%s\033[K", text.c_str());
}

double ProgressLine::seconds() const {
  return std::chrono::duration<double>(Clock::now() - start_).count();
}

std::string describe(const RunProgress& progress, double seconds) {
  const double rate = static_cast<double>(progress.scans) / std::max(seconds, 1e-3);
  std::string text = std::to_string(progress.scans);
  if (progress.scans_expected) text += "/" + std::to_string(*progress.scans_expected);
  text += " scans  " + format("%.1f/s", rate);
  if (progress.log_seconds > 0.0) {
    text += format("  %.1f x real time", progress.log_seconds / std::max(seconds, 1e-3));
  }
  text += format("  %.0f m", progress.distance);
  if (progress.scans_expected && rate > 0.0 && *progress.scans_expected > progress.scans) {
    const auto left = static_cast<double>(*progress.scans_expected - progress.scans);
    text += "  " + clock_text(left / rate) + " left";
  }
  return text;
}

}  // namespace kissmap
