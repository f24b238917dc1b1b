// SPDX-License-Identifier: MIT
#include "kissmap/occupancy/log_odds.hpp"

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <limits>

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
double change(std::initializer_list<double> values, double unit) {
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
  const double smallest = std::min(hit, miss);
  const double largest = std::max({hit, miss, low, high});
  double best_cost = std::numeric_limits<double>::infinity();
  double unit = 0.0;
  for (int n = 1; largest * n / smallest < max_units; ++n) {
    const double candidate = smallest / n;
    const double of_steps = change({hit, miss}, candidate);
    const double of_clamps = change({low, high}, candidate);
    if (std::max(of_steps, of_clamps) > max_change) continue;
    // The ratio of the steps decides between occupied and free, the clamps only how soon.
    const double cost = of_steps + 0.1 * of_clamps;
    if (cost < best_cost) {
      best_cost = cost;
      unit = candidate;
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
