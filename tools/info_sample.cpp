// SPDX-License-Identifier: MIT
#include "info_sample.hpp"

#include <algorithm>
#include <vector>

#include "report.hpp"

namespace kissmap {
namespace {

constexpr std::size_t most_scans = 5;  // of a large sensor's packets they are some 20 MB

struct Sample {
  std::size_t scans = 0;
  std::uint64_t points = 0;
  std::vector<std::int64_t> stamps_ns;

  void add(const LogEntry& entry) {
    const auto* scan = std::get_if<Scan>(&entry.content);
    if (scan == nullptr) return;
    ++scans;
    points += scan->points.size();
    stamps_ns.push_back(scan->stamp_ns);
  }
};

// The middle one of the steps in time: a gap, or a first sweep that is not whole, does not count.
double middle_step_s(const std::vector<std::int64_t>& stamps_ns) {
  std::vector<double> steps;
  for (std::size_t i = 1; i < stamps_ns.size(); ++i) {
    steps.push_back(static_cast<double>(stamps_ns[i]) - static_cast<double>(stamps_ns[i - 1]));
  }
  std::ranges::sort(steps);
  return 1e-9 * steps[steps.size() / 2];
}

}  // namespace

std::string describe_rate(std::size_t scans, double seconds) {
  if (scans < 2 || seconds <= 0.0) return "";
  return text(", %.2f scans a second", static_cast<double>(scans - 1) / seconds);
}

std::string describe_sample(ScanLog& log, const LogEntry& first) {
  Sample sample;
  sample.add(first);
  for (std::size_t i = 1; i < most_scans; ++i) {
    const std::optional<LogEntry> next = log.next();
    if (!next) break;
    sample.add(*next);
  }
  if (sample.scans < 2) return "";
  return text("  sample      the first %zu scans: %s returns each%s\n",
              sample.scans,
              with_commas(sample.points / sample.scans).c_str(),
              describe_rate(2, middle_step_s(sample.stamps_ns)).c_str());
}

}  // namespace kissmap
