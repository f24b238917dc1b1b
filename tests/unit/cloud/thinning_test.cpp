// SPDX-License-Identifier: MIT
#include "thinning.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <vector>

namespace kissmap {
namespace {

std::vector<std::size_t> picked(std::size_t count, std::size_t most) {
  std::vector<std::size_t> indices;
  Thinning(count, most).for_each([&indices](std::size_t i) { indices.push_back(i); });
  return indices;
}

TEST(Thinning, LeavesNoMoreThanThatAscendingAndNoGapOfTwoGroups) {
  for (const std::size_t count : {2U, 100U, 999U, 1000U, 1001U, 2000U, 2001U, 65'536U}) {
    for (const std::size_t most : {1U, 7U, 1000U}) {
      const std::vector<std::size_t> indices = picked(count, most);
      const std::size_t group = (count + most - 1) / most;
      ASSERT_LE(indices.size(), most) << count;
      EXPECT_GE(indices.size() + 1, count / group) << count << " " << most;
      EXPECT_TRUE(std::ranges::is_sorted(indices, std::less_equal<>())) << count;
      EXPECT_LT(indices.back(), count);
      EXPECT_LT(indices.front(), group);
      for (std::size_t i = 1; i < indices.size(); ++i) {
        ASSERT_LT(indices[i] - indices[i - 1], 2 * group);
      }
    }
  }
}

TEST(Thinning, LeavesAllOfFew) {
  EXPECT_TRUE(picked(0, 5).empty());
  EXPECT_TRUE(picked(0, 0).empty());
  EXPECT_EQ(picked(1, 1), std::vector<std::size_t>{0});
  EXPECT_EQ(picked(5, 5), (std::vector<std::size_t>{0, 1, 2, 3, 4}));
}

TEST(Thinning, LasersThatTakeTurnsHaveEqualShares) {
  constexpr std::size_t count = 131'072;
  for (const std::size_t lasers : {6U, 16U, 32U, 40U, 64U, 128U}) {
    for (const std::size_t most : {6'000U, 16'384U, 50'000U}) {
      std::vector<int> of_laser(lasers);
      const std::vector<std::size_t> indices = picked(count, most);
      for (const std::size_t i : indices) ++of_laser[i % lasers];
      const auto share = static_cast<double>(indices.size()) / static_cast<double>(lasers);
      for (const int n : of_laser) EXPECT_NEAR(n, share, 0.25 * share) << lasers << " " << most;
    }
  }
}

}  // namespace
}  // namespace kissmap
