// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>

namespace kissmap {

/// How a voxel's probability of being occupied follows from what scans say of it (Thrun, Burgard,
/// Fox: Probabilistic Robotics, 9.2; clamping: Yguel, Aycard, Laugier 2008).
struct OccupancyOptions {
  double hit = 0.7;      ///< probability of a voxel with a hit in it, one scan
  double miss = 0.45;    ///< the same of a voxel only seen through
  double lowest = 0.12;  ///< probabilities are kept between these
  double highest = 0.97;
  double free_margin = 0.1;  ///< m before a hit that are not taken for free
};
/// Throws Error(usage) naming the field, its value and its range.
void require_valid(const OccupancyOptions& options);

/// Log-odds of one voxel in steps of 1/30, in a byte; 30 steps are a factor of e.
using LogOdds = std::int8_t;
inline constexpr LogOdds never_seen = std::numeric_limits<LogOdds>::min();

/// The options as whole steps.
class LogOddsModel {
 public:
  explicit LogOddsModel(const OccupancyOptions& options)
      : hit_(steps(options.hit)),
        miss_(steps(options.miss)),
        lowest_(steps(options.lowest)),
        highest_(steps(options.highest)) {}

  LogOdds after_hit(LogOdds before) const { return moved(before, hit_); }
  LogOdds after_miss(LogOdds before) const { return moved(before, miss_); }

  /// NaN for a voxel never seen.
  static float probability(LogOdds value) {
    if (value == never_seen) return std::numeric_limits<float>::quiet_NaN();
    return 1.0F / (1.0F + std::exp(-static_cast<float>(value) / steps_per_unit));
  }

 private:
  static constexpr float steps_per_unit = 30.0F;

  static int steps(double probability) {
    const double log_odds = std::log(probability / (1.0 - probability));
    return static_cast<int>(std::lround(static_cast<double>(steps_per_unit) * log_odds));
  }
  LogOdds moved(LogOdds before, int by) const {
    const int known = before == never_seen ? 0 : before;
    return static_cast<LogOdds>(std::clamp(known + by, lowest_, highest_));
  }

  int hit_;
  int miss_;
  int lowest_;
  int highest_;
};

}  // namespace kissmap
