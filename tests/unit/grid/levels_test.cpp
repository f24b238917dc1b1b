// SPDX-License-Identifier: MIT
#include "kissmap/grid/levels.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <utility>

namespace kissmap {
namespace {

void go(SensorPath& path, const Eigen::Vector3d& end) {
  const Eigen::Vector3d start = path.empty() ? end : path.back();
  const int steps = std::max(1, static_cast<int>((end - start).norm() / 0.3));
  for (int i = 1; i <= steps; ++i) path.push_back(start + (end - start) * i / steps);
}

/// A lap over a square of 40 m, at a height.
void lap(SensorPath& path, double z) {
  for (const auto& [x, y] : {std::pair(0, 0), {40, 0}, {40, 40}, {0, 40}, {0, 0}}) {
    go(path, Eigen::Vector3d(x, y, z));
  }
}

/// From the corner of the laps away over a ramp of 10 degrees outside of them, and round to the
/// corner again, higher or lower.
void ramp(SensorPath& path, double from, double to) {
  if (to > from) {
    go(path, {-17.0, 0.0, to});
    go(path, {-17.0, -10.0, to});
    go(path, {0.0, -10.0, to});
  } else {
    go(path, {0.0, -10.0, from});
    go(path, {-17.0, -10.0, from});
    go(path, {-17.0, 0.0, from});
  }
  go(path, {0.0, 0.0, to});
}

TEST(Levels, AHillThatNeverMeetsItselfIsOne) {
  SensorPath path;
  for (int i = 0; i < 2000; ++i) {
    const double angle = 2.0 * std::numbers::pi * i / 1000.0;  // two laps of a hilly street
    path.emplace_back(100.0 * std::cos(angle), 100.0 * std::sin(angle), 9.0 * std::sin(angle));
  }
  EXPECT_EQ(levels_of(path), std::vector<std::uint32_t>(path.size(), 0));
  EXPECT_TRUE(levels_of({}).empty());
}

TEST(Levels, UpAndDownAGarageAreTwo) {
  SensorPath path;
  lap(path, 1.8);
  const std::size_t up = path.size();
  ramp(path, 1.8, 4.8);
  const std::size_t there = path.size();
  lap(path, 4.8);
  const std::size_t down = path.size();
  ramp(path, 4.8, 1.8);
  const std::size_t back = path.size();
  lap(path, 1.8);
  const std::vector<std::uint32_t> levels = levels_of(path);
  ASSERT_EQ(levels.size(), path.size());
  for (std::size_t i = 0; i < path.size(); ++i) {
    const bool below = i < up || i >= back;
    const bool above = i >= there && i < down;
    if (below || above) {
      EXPECT_EQ(levels[i], above ? 1U : 0U) << i;
    }
    if (i > 0 && levels[i] != levels[i - 1]) {
      EXPECT_NEAR(path[i].z(), 3.3, 0.9) << "cut on the ramp";
    }
  }
}

TEST(Levels, AreInTheOrderOfTheirHeights) {
  SensorPath path;
  lap(path, 7.0);
  ramp(path, 7.0, 4.0);
  lap(path, 4.0);
  ramp(path, 4.0, 1.0);
  lap(path, 1.0);
  const std::vector<std::uint32_t> levels = levels_of(path);
  EXPECT_EQ(levels.front(), 2U);
  EXPECT_EQ(levels[levels.size() / 2], 1U);
  EXPECT_EQ(levels.back(), 0U);
}

}  // namespace
}  // namespace kissmap
