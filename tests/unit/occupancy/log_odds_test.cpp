// SPDX-License-Identifier: MIT
#include "kissmap/occupancy/log_odds.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "kissmap/error.hpp"

namespace kissmap {
namespace {

double log_odds(double p) {
  return std::log(p / (1.0 - p));
}

TEST(LogOdds, DefaultsChangeByLessThanAThirdOfAPercent) {
  const LogOddsSteps steps = LogOddsSteps::from({});
  EXPECT_NEAR(steps.hit * steps.unit / log_odds(0.7), 1.0, 0.0033);
  EXPECT_NEAR(-steps.miss * steps.unit / log_odds(0.4), 1.0, 0.0033);
  EXPECT_NEAR(steps.min * steps.unit / log_odds(0.12), 1.0, 0.0033);
  EXPECT_NEAR(steps.max * steps.unit / log_odds(0.97), 1.0, 0.0033);
  EXPECT_EQ(steps.occupied, 0);
}

TEST(LogOdds, ProbabilityInvertsThem) {
  const LogOddsSteps steps = LogOddsSteps::from({});
  for (int value = steps.min; value <= steps.max; ++value) {
    const double p = steps.probability(static_cast<LogOdds>(value));
    EXPECT_NEAR(log_odds(p), value * steps.unit, 1e-12);
    EXPECT_EQ(steps.is_occupied(static_cast<LogOdds>(value)), p > 0.5);
    EXPECT_NE(steps.is_occupied(static_cast<LogOdds>(value)),
              steps.is_free(static_cast<LogOdds>(value)));
  }
  EXPECT_EQ(steps.probability(unknown_log_odds), 0.5);
  EXPECT_FALSE(steps.is_occupied(unknown_log_odds));
  EXPECT_FALSE(steps.is_free(unknown_log_odds));
}

TEST(LogOdds, OccupiedMeansAboveItsProbability) {
  for (const double p : {0.13, 0.3, 0.5, 0.65, 0.9}) {
    LogOddsOptions options;
    options.occupied_probability = p;
    const LogOddsSteps steps = LogOddsSteps::from(options);
    for (int value = steps.min; value <= steps.max; ++value) {
      const double probability = steps.probability(static_cast<LogOdds>(value));
      if (std::abs(probability - p) < 1e-9) continue;
      ASSERT_EQ(steps.is_occupied(static_cast<LogOdds>(value)), probability > p) << p;
    }
  }
}

TEST(LogOdds, ManyModelsFit) {
  for (const double hit : {0.55, 0.7, 0.9}) {
    for (const double miss : {0.3, 0.4, 0.45}) {
      for (const double limit : {0.95, 0.99}) {
        const LogOddsSteps steps = LogOddsSteps::from({hit, miss, 1 - limit, limit, 0.5});
        EXPECT_NEAR(steps.hit * steps.unit / log_odds(hit), 1.0, 0.05);
        EXPECT_NEAR(-steps.miss * steps.unit / log_odds(miss), 1.0, 0.05);
        EXPECT_GE(steps.min, -127);
      }
    }
  }
}

TEST(LogOdds, RefusesModelsThatMakeNoSense) {
  EXPECT_THROW(LogOddsSteps::from({0.5, 0.4, 0.12, 0.97, 0.5}), Error);
  EXPECT_THROW(LogOddsSteps::from({0.7, 0.5, 0.12, 0.97, 0.5}), Error);
  EXPECT_THROW(LogOddsSteps::from({0.7, 0.4, 0.0, 0.97, 0.5}), Error);
  EXPECT_THROW(LogOddsSteps::from({0.7, 0.4, 0.12, 1.0, 0.5}), Error);
  EXPECT_THROW(LogOddsSteps::from({0.7, 0.4, 0.12, 0.97, 0.98}), Error);
  EXPECT_THROW(LogOddsSteps::from({std::nan(""), 0.4, 0.12, 0.97, 0.5}), Error);
  // A step of 0.004 under a clamp of 6.9 cannot be a whole number below 128.
  EXPECT_THROW(LogOddsSteps::from({0.7, 0.499, 0.001, 0.999, 0.5}), Error);
}

}  // namespace
}  // namespace kissmap
