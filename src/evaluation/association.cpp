// SPDX-License-Identifier: MIT
#include "kissmap/evaluation/association.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <optional>
#include <string>

#include "kissmap/error.hpp"
#include "options.hpp"

namespace kissmap {
namespace {

constexpr double max_tolerance = 1e6;  // s
constexpr double max_offset = 4e9;     // s, from 1970 to nearly 2100

using Stamps = std::vector<std::int64_t>;
using Seconds = std::vector<double>;

// The double nearest to the decimal stamp, as a reader of seconds gets it.
Seconds seconds_from(const Stamps& stamps_ns) {
  Seconds seconds;
  seconds.reserve(stamps_ns.size());
  for (const std::int64_t stamp : stamps_ns) {
    seconds.push_back(static_cast<double>(static_cast<long double>(stamp) / 1e9L));
  }
  return seconds;
}

// The first of several equally near.
std::size_t nearest(const Seconds& ascending, double stamp) {
  auto best = std::ranges::lower_bound(ascending, stamp);
  const bool none_after = best == ascending.end();
  if (best != ascending.begin()) {
    const double before = *std::prev(best);
    if (none_after || stamp - before <= *best - stamp) {
      best = std::ranges::lower_bound(ascending, before);
    }
  }
  return static_cast<std::size_t>(best - ascending.begin());
}

std::string span_of(const Seconds& stamps) {
  char text[96];
  std::snprintf(text, sizeof text, "%.3f to %.3f s", stamps.front(), stamps.back());
  return text;
}

Error nothing_in_common(const Seconds& reference,
                        const Seconds& estimate,
                        const AssociationOptions& options) {
  const bool overlap = reference.front() <= estimate.back() + options.offset &&
                       estimate.front() + options.offset <= reference.back();
  const double ahead = reference.front() - estimate.front();
  std::string message = "no pose belongs to one of the reference: the stamps go from " +
                        span_of(estimate) + ", those of the reference from " + span_of(reference);
  char text[160];
  if (overlap && options.interpolate) {
    std::snprintf(text,
                  sizeof text,
                  "; they overlap, but none lies between two that are within %g s: raise the "
                  "maximum gap",
                  options.max_gap);
  } else if (overlap) {
    std::snprintf(text,
                  sizeof text,
                  "; they overlap, but no two are within %g s: interpolate, or raise the "
                  "tolerance",
                  options.tolerance);
  } else {
    std::snprintf(text,
                  sizeof text,
                  "; they do not overlap. If both begin at once, an offset of %.3f s joins them",
                  ahead);
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
  const bool estimate_longer = estimate.size() > reference.size();
  const Seconds shorter = seconds_from((estimate_longer ? reference : estimate).stamps_ns);
  Seconds longer = seconds_from((estimate_longer ? estimate : reference).stamps_ns);
  const double offset = estimate_longer ? options.offset : -options.offset;
  for (double& stamp : longer) stamp += offset;
  PosePairs pairs;
  pairs.by_stamp = true;
  for (std::size_t i = 0; i < shorter.size(); ++i) {
    const std::size_t j = nearest(longer, shorter[i]);
    if (std::abs(longer[j] - shorter[i]) > options.tolerance) continue;
    const std::size_t reference_idx = estimate_longer ? i : j;
    append(pairs, reference, estimate, reference_idx, estimate_longer ? j : i);
    pairs.stamps_ns.push_back(reference.stamps_ns[reference_idx]);
  }
  if (pairs.size() > 0) return pairs;
  throw nothing_in_common(
      seconds_from(reference.stamps_ns), seconds_from(estimate.stamps_ns), options);
}

// Holds every stamp with an offset exactly.
using Nanoseconds = long double;

struct Interpolation {
  Rigid3 pose;
  std::size_t before = 0;
};

std::optional<Interpolation> pose_at(const Trajectory& trajectory,
                                     Nanoseconds time,
                                     Nanoseconds max_gap) {
  const Stamps& stamps = trajectory.stamps_ns;
  const auto found = std::ranges::lower_bound(
      stamps, time, {}, [](std::int64_t stamp) { return static_cast<Nanoseconds>(stamp); });
  if (found == stamps.end()) return std::nullopt;
  const auto after = static_cast<std::size_t>(found - stamps.begin());
  if (static_cast<Nanoseconds>(*found) == time) {
    return Interpolation{trajectory.poses[after], after};
  }
  if (after == 0) return std::nullopt;
  const std::size_t before = after - 1;
  const auto gap = static_cast<Nanoseconds>(stamps[after] - stamps[before]);
  if (gap > max_gap) return std::nullopt;
  const Rigid3& start = trajectory.poses[before];
  const auto part = static_cast<double>((time - static_cast<Nanoseconds>(stamps[before])) / gap);
  const Twist motion = part * log(start.inverse() * trajectory.poses[after]);
  return Interpolation{start * exp(motion), before};
}

/// Infinite for a single instant.
double median_step(const Stamps& stamps_ns) {
  std::vector<double> steps;
  for (std::size_t i = 1; i < stamps_ns.size(); ++i) {
    if (stamps_ns[i] == stamps_ns[i - 1]) continue;
    steps.push_back(static_cast<double>(stamps_ns[i] - stamps_ns[i - 1]));
  }
  if (steps.empty()) return std::numeric_limits<double>::infinity();
  const auto middle = steps.begin() + static_cast<std::ptrdiff_t>(steps.size() / 2);
  std::ranges::nth_element(steps, middle);
  return *middle;
}

PosePairs pair_by_interpolation(const Trajectory& reference,
                                const Trajectory& estimate,
                                const AssociationOptions& options) {
  const bool in_estimate = median_step(reference.stamps_ns) > 2.0 * median_step(estimate.stamps_ns);
  const Trajectory& given = in_estimate ? reference : estimate;
  const auto in_ns = [](double seconds) {
    return std::round(static_cast<Nanoseconds>(seconds) * 1e9L);
  };
  const Nanoseconds offset = in_ns(in_estimate ? -options.offset : options.offset);
  PosePairs pairs;
  pairs.by_stamp = true;
  pairs.interpolated = in_estimate ? PosePairs::Side::estimate : PosePairs::Side::reference;
  for (std::size_t i = 0; i < given.size(); ++i) {
    const Nanoseconds time = static_cast<Nanoseconds>(given.stamps_ns[i]) + offset;
    const auto found = pose_at(in_estimate ? estimate : reference, time, in_ns(options.max_gap));
    if (!found) continue;
    pairs.reference.push_back(in_estimate ? given.poses[i] : found->pose);
    pairs.estimate.push_back(in_estimate ? found->pose : given.poses[i]);
    pairs.reference_idx.push_back(in_estimate ? i : found->before);
    pairs.estimate_idx.push_back(in_estimate ? found->before : i);
    // Between stamps of the reference, so it fits.
    pairs.stamps_ns.push_back(in_estimate ? given.stamps_ns[i] : static_cast<std::int64_t>(time));
  }
  if (pairs.size() > 0) return pairs;
  throw nothing_in_common(
      seconds_from(reference.stamps_ns), seconds_from(estimate.stamps_ns), options);
}

}  // namespace

void require_valid(const AssociationOptions& options) {
  require_between("tolerance", options.tolerance, 0.0, max_tolerance);
  require_between("offset", options.offset, -max_offset, max_offset);
  require_between("maximum gap", options.max_gap, 0.0, max_tolerance);
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
  if (options.interpolate && !by_stamp) {
    throw Error(Fault::input, "to interpolate, both trajectories need stamps; name a file of them");
  }
  const auto pair = options.interpolate ? pair_by_interpolation : pair_by_stamp;
  PosePairs pairs =
      by_stamp ? pair(reference, estimate, options) : pair_by_index(reference, estimate);
  pairs.positions_only = reference.positions_only || estimate.positions_only;
  return pairs;
}

}  // namespace kissmap
