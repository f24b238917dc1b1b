// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <functional>

namespace kissmap {

/// How far an open local map has come, after its latest scan.
struct LocalMapProgress {
  std::uint64_t scan_count = 0;
  double displacement = 0.0;  ///< m, latest scan from the keypose
  double path_length = 0.0;   ///< m
};

/// Says after each scan whether the open local map should be closed. Must be a pure function of
/// what it is given, so that a log always splits in the same places.
using SplittingRule = std::function<bool(const LocalMapProgress&)>;

/// METHOD section 2: close when the displacement from the keypose exceeds `distance` [m].
inline SplittingRule split_by_displacement(double distance) {
  return [distance](const LocalMapProgress& progress) { return progress.displacement > distance; };
}

}  // namespace kissmap
