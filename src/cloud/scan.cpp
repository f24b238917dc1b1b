// SPDX-License-Identifier: MIT
#include "kissmap/cloud/scan.hpp"

#include <algorithm>
#include <cmath>

#include "kissmap/error.hpp"

namespace kissmap {
namespace {

void require(bool holds, const char* invariant) {
  if (!holds) throw Error(Fault::internal, std::string("inconsistent scan: ") + invariant);
}

bool parallel_or_empty(std::size_t size, std::size_t expected) {
  return size == 0 || size == expected;
}

}  // namespace

DroppedReturns& DroppedReturns::operator+=(const DroppedReturns& other) {
  non_finite += other.non_finite;
  zero += other.zero;
  implausible += other.implausible;
  return *this;
}

std::optional<TimeSpan> time_span(const Scan& scan) {
  if (scan.time_offsets.empty()) return std::nullopt;
  const auto [first, last] = std::ranges::minmax(scan.time_offsets);
  return TimeSpan{first, last};
}

void require_consistent(const Scan& scan) {
  const std::size_t n = scan.points.size();
  require(parallel_or_empty(scan.time_offsets.size(), n), "times and points differ in number");
  require(parallel_or_empty(scan.intensities.size(), n), "intensities and points differ in number");
  require(parallel_or_empty(scan.no_return_time_offsets.size(), scan.no_return_directions.size()),
          "no-return times and directions differ in number");
  require(n == 0 || scan.time_offsets.empty() == (scan.time_source == TimeSource::none),
          "times without a source, or a source without times");
  require(std::ranges::all_of(scan.time_offsets, [](float t) { return std::isfinite(t); }),
          "a time offset is not finite");
  require(std::ranges::all_of(scan.points,
                              [](const Eigen::Vector3f& p) {
                                return p.allFinite() && !p.isZero(0.0F) &&
                                       p.norm() <= max_plausible_range;
                              }),
          "a point is not finite, zero or implausibly far");
}

}  // namespace kissmap
