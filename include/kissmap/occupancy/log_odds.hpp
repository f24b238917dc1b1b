// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>

namespace kissmap {

/// Parameters of the inverse sensor model (Thrun, Burgard, Fox: Probabilistic Robotics, 2005,
/// chapter 9). Defaults are those of OctoMap.
struct LogOddsOptions {
  double hit_probability = 0.7;       ///< of a voxel that a ray ends in; above 0.5
  double miss_probability = 0.4;      ///< of a voxel that a ray crosses; below 0.5
  double min_probability = 0.12;      ///< clamp; below 0.5
  double max_probability = 0.97;      ///< clamp; above 0.5
  double occupied_probability = 0.5;  ///< a voxel is occupied above it; between the clamps
};

/// A voxel's belief: log-odds in whole multiples of a unit. Whole numbers add without rounding, so
/// that the order of updates never matters between the clamps.
using LogOdds = std::int8_t;

/// The belief of a voxel never seen, which is no number of units.
inline constexpr LogOdds unknown_log_odds = -128;

/// The options in units. The unit is the one, among those in which the clamps fit into LogOdds,
/// that changes the steps least by rounding, then the clamps: for the defaults the ratio of hit to
/// miss by 0.06 %, the clamps by 0.3 %. Of voxels hit at any rate, rounding then changes whether
/// one is occupied in less than 1 of 2000 cases.
struct LogOddsSteps {
  double unit = 0.0;     ///< log-odds of one
  LogOdds hit = 0;       ///< added by a hit, > 0
  LogOdds miss = 0;      ///< subtracted by a miss, > 0
  LogOdds min = 0;       ///< < 0
  LogOdds max = 0;       ///< > 0
  LogOdds occupied = 0;  ///< occupied means above this

  /// Throws Error(usage) naming an option out of range, or if the steps are so far apart that
  /// rounding would change one by more than 5 %.
  static LogOddsSteps from(const LogOddsOptions& options);

  double probability(LogOdds value) const;  ///< 0.5 for unknown_log_odds
  bool is_occupied(LogOdds value) const { return value > occupied; }
  bool is_free(LogOdds value) const { return value != unknown_log_odds && value <= occupied; }
};

}  // namespace kissmap
