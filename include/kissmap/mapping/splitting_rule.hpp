// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>
#include <cstdint>
#include <functional>

namespace kissmap {

/// How far an open local map has come, after its latest scan.
struct LocalMapProgress {
  std::uint64_t scan_count = 0;
  double displacement = 0.0;  ///< m, latest scan from the keypose
  double path_length = 0.0;   ///< m, in steps of half a metre, so that noise does not count
  double mean_range = 0.0;    ///< m, of the thinned points of its scans
};

/// Says after each scan whether the open local map should be closed. Must be a pure function of
/// what it is given, so that a log always splits in the same places.
using SplittingRule = std::function<bool(const LocalMapProgress&)>;

/// METHOD section 2: close when the displacement from the keypose exceeds `distance` [m].
inline SplittingRule split_by_displacement(double distance) {
  return [distance](const LocalMapProgress& progress) { return progress.displacement > distance; };
}

/// Closes a local map when it has left what it saw at first: at a displacement of one mean range
/// from the keypose, `shortest` [m] at least and `longest` at most. A path of twice that closes it
/// too, so that walking round in a hall makes local maps that can be compared.
inline SplittingRule split_by_range(double shortest, double longest) {
  return [=](const LocalMapProgress& progress) {
    const double distance = std::max(shortest, std::min(longest, progress.mean_range));
    return progress.displacement > distance || progress.path_length > 2.0 * distance;
  };
}

}  // namespace kissmap
