// SPDX-License-Identifier: MIT
#include "kissmap/evaluation/association.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <string>

#include "kissmap/error.hpp"
#include "options.hpp"

namespace kissmap {
namespace {

constexpr double ns_per_s = 1e9;
constexpr double max_tolerance = 1e6;  // s
constexpr double max_offset = 4e9;     // s, from 1970 to nearly 2100

using Stamps = std::vector<std::int64_t>;

// Never overflows: at most 2^64.
std::uint64_t apart(std::int64_t a, std::int64_t b) {
  const auto x = static_cast<std::uint64_t>(a);
  const auto y = static_cast<std::uint64_t>(b);
  return a > b ? x - y : y - x;
}

std::size_t nearest(const Stamps& stamps, std::int64_t stamp) {
  const auto after = std::ranges::lower_bound(stamps, stamp);
  const auto idx = static_cast<std::size_t>(after - stamps.begin());
  if (idx == 0) return 0;
  if (idx == stamps.size()) return idx - 1;
  return apart(stamps[idx - 1], stamp) <= apart(stamps[idx], stamp) ? idx - 1 : idx;
}

Stamps shifted(const Stamps& stamps, double seconds) {
  const auto offset_ns = static_cast<std::int64_t>(std::llround(seconds * ns_per_s));
  Stamps result = stamps;
  for (std::int64_t& stamp : result) {
    if (!__builtin_add_overflow(stamp, offset_ns, &stamp)) continue;
    throw Error(Fault::input, "a stamp plus the offset leaves the range of 64-bit nanoseconds");
  }
  return result;
}

std::string seconds_of(std::int64_t stamp_ns) {
  char text[48];
  std::snprintf(text, sizeof text, "%.3f", static_cast<double>(stamp_ns) / ns_per_s);
  return text;
}

std::string span_of(const Stamps& stamps) {
  return seconds_of(stamps.front()) + " to " + seconds_of(stamps.back()) + " s";
}

Error nothing_in_common(const Stamps& reference, const Stamps& estimate, double tolerance) {
  const bool overlap = reference.front() <= estimate.back() && estimate.front() <= reference.back();
  const double ahead =
      static_cast<double>(reference.front()) - static_cast<double>(estimate.front());
  std::string message = "no pose belongs to one of the reference: its stamps go from " +
                        span_of(estimate) + ", those of the reference from " + span_of(reference);
  char text[160];
  if (overlap) {
    std::snprintf(text,
                  sizeof text,
                  "; they overlap, but no two are within %g s: raise the tolerance",
                  tolerance);
  } else {
    std::snprintf(text,
                  sizeof text,
                  "; they do not overlap. If both begin at once, an offset of %.3f s joins them",
                  ahead / ns_per_s);
  }
  return {Fault::input, message + text};
}

void append(PosePairs& pairs,
            const Trajectory& reference,
            const Trajectory& estimate,
            std::size_t reference_idx,
            std::size_t estimate_idx) {
  pairs.reference.push_back(reference.poses[reference_idx]);
  pairs.estimate.push_back(estimate.poses[estimate_idx]);
  pairs.reference_idx.push_back(reference_idx);
  pairs.estimate_idx.push_back(estimate_idx);
}

PosePairs pair_by_index(const Trajectory& reference, const Trajectory& estimate) {
  if (reference.size() != estimate.size()) {
    throw Error(Fault::input,
                std::to_string(estimate.size()) + " poses, but the reference has " +
                    std::to_string(reference.size()) +
                    " and not both have stamps to pair them by; name a file of stamps");
  }
  PosePairs pairs;
  for (std::size_t i = 0; i < reference.size(); ++i) append(pairs, reference, estimate, i, i);
  pairs.stamps_ns = reference.has_stamps() ? reference.stamps_ns : estimate.stamps_ns;
  return pairs;
}

PosePairs pair_by_stamp(const Trajectory& reference,
                        const Trajectory& estimate,
                        const AssociationOptions& options) {
  const Stamps estimate_stamps = shifted(estimate.stamps_ns, options.offset);
  const auto tolerance_ns = static_cast<std::uint64_t>(std::llround(options.tolerance * ns_per_s));
  const bool estimate_longer = estimate.size() > reference.size();
  const Stamps& shorter = estimate_longer ? reference.stamps_ns : estimate_stamps;
  const Stamps& longer = estimate_longer ? estimate_stamps : reference.stamps_ns;
  PosePairs pairs;
  pairs.by_stamp = true;
  for (std::size_t i = 0; i < shorter.size(); ++i) {
    const std::size_t j = nearest(longer, shorter[i]);
    if (apart(longer[j], shorter[i]) > tolerance_ns) continue;
    const std::size_t reference_idx = estimate_longer ? i : j;
    append(pairs, reference, estimate, reference_idx, estimate_longer ? j : i);
    pairs.stamps_ns.push_back(reference.stamps_ns[reference_idx]);
  }
  if (pairs.size() == 0) {
    throw nothing_in_common(reference.stamps_ns, estimate_stamps, options.tolerance);
  }
  return pairs;
}

}  // namespace

void require_valid(const AssociationOptions& options) {
  require_between("tolerance", options.tolerance, 0.0, max_tolerance);
  require_between("offset", options.offset, -max_offset, max_offset);
}

PosePairs associate(const Trajectory& reference,
                    const Trajectory& estimate,
                    const AssociationOptions& options) {
  require_valid(options);
  require_valid(reference);
  require_valid(estimate);
  if (reference.size() == 0 || estimate.size() == 0) {
    throw Error(Fault::input, "a trajectory without poses cannot be compared");
  }
  const bool by_stamp = reference.has_stamps() && estimate.has_stamps();
  return by_stamp ? pair_by_stamp(reference, estimate, options)
                  : pair_by_index(reference, estimate);
}

}  // namespace kissmap
