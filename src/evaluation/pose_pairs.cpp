// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cmath>

#include "kissmap/error.hpp"
#include "kissmap/evaluation/pose_error.hpp"
#include "kissmap/evaluation/trajectory.hpp"
#include "options.hpp"

namespace kissmap {
namespace {

using Pairs = std::vector<std::pair<std::size_t, std::size_t>>;

constexpr double share_of_delta = 0.1;  // how far a pair may be off

Pairs by_frames(std::size_t poses, std::size_t delta, PairChoice choice) {
  Pairs pairs;
  const std::size_t step = choice == PairChoice::all ? 1 : delta;
  for (std::size_t i = 0; delta < poses && i < poses - delta; i += step) {
    pairs.emplace_back(i, i + delta);
  }
  return pairs;
}

Pairs between_marks(const std::vector<Rigid3>& poses, double delta) {
  Pairs pairs;
  std::size_t mark = 0;
  bool has_mark = false;
  double way = 0.0;
  for (std::size_t i = 1; i < poses.size(); ++i) {
    way += (poses[i].translation - poses[i - 1].translation).norm();
    if (way < delta) continue;
    if (has_mark) pairs.emplace_back(mark, i);
    has_mark = true;
    mark = i;
    way = 0.0;
  }
  return pairs;
}

/// The j > i for which place[j] - place[i] is nearest to delta, the first of several, or i if it is
/// off by more than `tolerance`. `place` never falls.
template <typename Number>
std::size_t partner(const std::vector<Number>& place,
                    std::size_t i,
                    Number delta,
                    Number tolerance) {
  const auto from = place.begin() + static_cast<std::ptrdiff_t>(i) + 1;
  const auto first_with = [&](Number least) {
    return std::partition_point(from, place.end(), [&](Number p) { return p - place[i] < least; });
  };
  auto best = first_with(delta);
  if (best != from) {
    const Number short_of = delta - (*std::prev(best) - place[i]);
    const bool shorter_is_nearer = best == place.end() || short_of <= (*best - place[i]) - delta;
    if (shorter_is_nearer) best = first_with(*std::prev(best) - place[i]);
  }
  if (best == place.end()) return i;
  const Number off = (*best - place[i]) - delta;
  return (off < 0 ? -off : off) > tolerance ? i : static_cast<std::size_t>(best - place.begin());
}

Pairs by_metres(const std::vector<Rigid3>& poses, double delta) {
  const std::vector<double> distances = distances_along(poses);
  Pairs pairs;
  for (std::size_t i = 0; i + 1 < distances.size(); ++i) {
    const std::size_t j = partner(distances, i, delta, share_of_delta * delta);
    if (j != i) pairs.emplace_back(i, j);
  }
  return pairs;
}

Pairs by_seconds(const std::vector<std::int64_t>& stamps_ns, double delta, PairChoice choice) {
  const auto delta_ns = static_cast<std::int64_t>(std::llround(1e9 * delta));
  const auto tolerance_ns = static_cast<std::int64_t>(std::llround(1e9 * share_of_delta * delta));
  Pairs pairs;
  for (std::size_t i = 0; i + 1 < stamps_ns.size();) {
    const std::size_t j = partner(stamps_ns, i, delta_ns, tolerance_ns);
    if (j != i) pairs.emplace_back(i, j);
    i = choice == PairChoice::all || j == i ? i + 1 : j;
  }
  return pairs;
}

}  // namespace

void require_valid(const Delta& delta) {
  constexpr double smallest = 1e-9;
  constexpr double largest = 1e9;
  require_between("delta", delta.value, smallest, largest);
  if (delta.unit == DeltaUnit::frames && delta.value != std::floor(delta.value)) {
    throw usage_error("a delta of frames is a whole number, not " + std::to_string(delta.value));
  }
}

Pairs choose_pairs(const std::vector<Rigid3>& poses,
                   const std::vector<std::int64_t>& stamps_ns,
                   const Delta& delta,
                   PairChoice choice) {
  require_valid(delta);
  switch (delta.unit) {
    case DeltaUnit::frames:
      return by_frames(poses.size(), static_cast<std::size_t>(delta.value), choice);
    case DeltaUnit::metres:
      return choice == PairChoice::all ? by_metres(poses, delta.value)
                                       : between_marks(poses, delta.value);
    case DeltaUnit::seconds:
      break;
  }
  if (stamps_ns.empty()) throw usage_error("a delta of seconds needs stamps; name a file of them");
  return by_seconds(stamps_ns, delta.value, choice);
}

}  // namespace kissmap
