// SPDX-License-Identifier: MIT
#include "kissmap/mapping/stamp_gaps.hpp"

#include <algorithm>

namespace kissmap {
namespace {

constexpr double shortest_gap = 1.0;  // s
constexpr double intervals_in_a_gap = 5.0;

}  // namespace

void StampGaps::observe(std::uint64_t log_index, std::int64_t stamp_ns) {
  if (last_stamp_) {
    const double seconds = 1e-9 * static_cast<double>(stamp_ns - *last_stamp_);
    intervals_.push_back(static_cast<float>(seconds));
    if (seconds > shortest_gap) candidates_.push_back({log_index, seconds});
  }
  last_stamp_ = stamp_ns;
}

std::vector<StampGap> StampGaps::gaps() const {
  if (candidates_.empty()) return {};
  std::vector<float> sorted = intervals_;
  const auto middle = sorted.begin() + static_cast<std::ptrdiff_t>(sorted.size() / 2);
  std::ranges::nth_element(sorted, middle);
  std::vector<StampGap> gaps;
  std::ranges::copy_if(candidates_, std::back_inserter(gaps), [&](const StampGap& gap) {
    return gap.seconds > intervals_in_a_gap * static_cast<double>(*middle);
  });
  return gaps;
}

}  // namespace kissmap
