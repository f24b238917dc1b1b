// SPDX-License-Identifier: MIT
#include "kissmap/occupancy/log_odds.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "kissmap/error.hpp"
#include "options.hpp"

namespace kissmap {
namespace {

constexpr double max_units = 127.0;
constexpr double max_change = 0.05;

double log_odds(double probability) {
  return std::log(probability / (1.0 - probability));
}

void require_valid(const LogOddsOptions& o) {
  require_between("hit_probability", o.hit_probability, 0.501, 0.999);
  require_between("miss_probability", o.miss_probability, 0.001, 0.499);
  require_between("min_probability", o.min_probability, 0.001, 0.499);
  require_between("max_probability", o.max_probability, 0.501, 0.999);
  require_between(
      "occupied_probability", o.occupied_probability, o.min_probability, o.max_probability);
}

/// Largest relative change by rounding to whole units.
double change(const std::array<double, 4>& values, double unit) {
  double worst = 0.0;
  for (const double value : values) {
    const double units = value / unit;
    worst = std::max(worst, std::abs(std::round(units) - units) / units);
  }
  return worst;
}

LogOdds in_units(double value, double unit) {
  return static_cast<LogOdds>(std::lround(value / unit));
}

}  // namespace

LogOddsSteps LogOddsSteps::from(const LogOddsOptions& options) {
  require_valid(options);
  const double hit = log_odds(options.hit_probability);
  const double miss = -log_odds(options.miss_probability);
  const double low = -log_odds(options.min_probability);
  const double high = log_odds(options.max_probability);
  const std::array<double, 4> values{hit, miss, low, high};
  const double smallest = std::min(hit, miss);
  const double largest = *std::ranges::max_element(values);
  double best_change = max_change;
  double unit = 0.0;
  for (int n = 1; largest * n / smallest < max_units; ++n) {
    if (const double c = change(values, smallest / n); c < best_change) {
      best_change = c;
      unit = smallest / n;
    }
  }
  if (unit == 0.0) {
    throw usage_error(
        "hit_probability, miss_probability and the clamps are too far apart to be added exactly: "
        "move them closer to each other");
  }
  return {unit,
          in_units(hit, unit),
          in_units(miss, unit),
          static_cast<LogOdds>(-in_units(low, unit)),
          in_units(high, unit),
          static_cast<LogOdds>(std::floor(log_odds(options.occupied_probability) / unit + 1e-9))};
}

double LogOddsSteps::probability(LogOdds value) const {
  if (value == unknown_log_odds) return 0.5;
  return 1.0 / (1.0 + std::exp(-unit * value));
}

}  // namespace kissmap
