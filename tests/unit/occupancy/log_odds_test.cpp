// SPDX-License-Identifier: MIT
#include "kissmap/occupancy/log_odds.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

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

TEST(LogOdds, DecideAsExactOnesDo) {
  // Voxels hit by chance: at no share of hits may rounding change what more than 1 in 1000 are.
  const LogOddsSteps steps = LogOddsSteps::from({});
  std::mt19937 random(1);
  for (unsigned percent = 5; percent < 100; percent += 5) {
    int different = 0;
    constexpr int decisions = 200'000;
    for (int voxel = 0; voxel < decisions / 50; ++voxel) {
      double exact = 0.0;
      int rounded = 0;
      for (int scan = 0; scan < 50; ++scan) {
        const bool hit = random() % 100 < percent;
        exact = std::clamp(exact + log_odds(hit ? 0.7 : 0.4), log_odds(0.12), log_odds(0.97));
        rounded = std::clamp<int>(rounded + (hit ? steps.hit : -steps.miss), steps.min, steps.max);
        if ((exact > 0.0) != steps.is_occupied(static_cast<LogOdds>(rounded))) ++different;
      }
    }
    EXPECT_LT(different, decisions / 1000) << percent << " % hits";
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
