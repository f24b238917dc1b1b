// SPDX-License-Identifier: MIT
#include "kissmap/mapping/stamp_gaps.hpp"

#include <gtest/gtest.h>

namespace kissmap {
namespace {

constexpr double second = 1e9;

std::vector<StampGap> gaps_of(const std::vector<double>& seconds) {
  StampGaps gaps;
  for (std::size_t i = 0; i < seconds.size(); ++i) {
    gaps.observe(i, static_cast<std::int64_t>(seconds[i] * second));
  }
  return gaps.gaps();
}

TEST(StampGaps, FindsAPauseWhereverItIs) {
  std::vector<double> stamps;
  for (int i = 0; i < 50; ++i)
    stamps.push_back(0.1 * i + (i >= 1 ? 7.0 : 0.0) + (i >= 30 ? 30.0 : 0.0));
  const auto gaps = gaps_of(stamps);
  ASSERT_EQ(gaps.size(), 2U);
  EXPECT_EQ(gaps[0].log_index, 1U);  // also before any usual interval was seen
  EXPECT_NEAR(gaps[0].seconds, 7.1, 1e-6);
  EXPECT_EQ(gaps[1].log_index, 30U);
  EXPECT_NEAR(gaps[1].seconds, 30.1, 1e-6);
}

TEST(StampGaps, SlowLogsAndLostScansAreNotGaps) {
  EXPECT_TRUE(gaps_of({0, 2, 4, 6, 8, 10}).empty()) << "one scan every two seconds";
  EXPECT_TRUE(gaps_of({0.0, 0.1, 0.2, 0.9, 1.0, 1.1}).empty()) << "half a dozen lost scans";
  EXPECT_TRUE(gaps_of({}).empty());
  EXPECT_TRUE(gaps_of({5.0}).empty());
}

}  // namespace
}  // namespace kissmap
