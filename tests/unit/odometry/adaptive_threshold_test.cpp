// SPDX-License-Identifier: MIT
#include "kissmap/odometry/adaptive_threshold.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace kissmap {
namespace {

Rigid3 motion(double metres, double radians) {
  Rigid3 m;
  m.translation.x() = metres;
  m.rotation = Eigen::AngleAxisd(radians, Eigen::Vector3d::UnitZ());
  return m;
}

TEST(AdaptiveThreshold, StartsAtItsInitialValue) {
  EXPECT_DOUBLE_EQ(AdaptiveThreshold(2.0, 0.1, 100.0).sigma(), 2.0);
}

TEST(AdaptiveThreshold, IgnoresSmallModelErrors) {
  AdaptiveThreshold threshold(2.0, 0.1, 100.0);
  threshold.observe(motion(0.1, 0.0));  // not above the limit
  EXPECT_DOUBLE_EQ(threshold.sigma(), 2.0);
}

TEST(AdaptiveThreshold, MatchesValuesComputedByHand) {
  AdaptiveThreshold threshold(2.0, 0.1, 100.0);
  threshold.observe(motion(0.3, 0.0));
  EXPECT_NEAR(threshold.sigma(), 1.4300349646, 1e-9);  // sqrt((4 + 0.09) / 2)
  // e = 0.5 + 2 * 100 * sin(0.005) = 1.4999958333
  threshold.observe(motion(0.5, 0.01));
  EXPECT_NEAR(threshold.sigma(), 1.4537293994, 1e-9);  // sqrt((4.09 + 1.4999958333^2) / 3)
}

TEST(AdaptiveThreshold, TurnsOfEitherSignCountTheSame) {
  AdaptiveThreshold left(2.0, 0.1, 50.0);
  AdaptiveThreshold right(2.0, 0.1, 50.0);
  left.observe(motion(0.0, 3.0));
  right.observe(motion(0.0, -3.0));
  EXPECT_DOUBLE_EQ(left.sigma(), right.sigma());
}

}  // namespace
}  // namespace kissmap
