// SPDX-License-Identifier: MIT
#include "kissmap/grid/wall_direction.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>
#include <vector>

namespace kissmap {
namespace {

std::vector<Eigen::Vector3f> walls_along(double angle, double share, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  std::normal_distribution<double> noise(0.0, 0.05);
  std::vector<Eigen::Vector3f> normals;
  for (int i = 0; i < 4000; ++i) {
    const double quarter = std::floor(4.0 * unit(random)) * std::numbers::pi / 2.0;
    const double at = unit(random) < share ? angle + quarter + noise(random)
                                           : 2.0 * std::numbers::pi * unit(random);
    normals.emplace_back(std::cos(at), std::sin(at), 0.0F);
    normals.emplace_back(0.0F, 0.05F, 1.0F);  // floor
  }
  return normals;
}

TEST(WallDirection, IsFoundAmongOtherThings) {
  for (const double degrees : {-44.0, -20.0, 0.0, 7.0, 31.0, 44.0}) {
    const double angle = degrees * std::numbers::pi / 180.0;
    EXPECT_NEAR(wall_direction(walls_along(angle, 0.6, 5)), angle, 0.01) << degrees;
  }
}

TEST(WallDirection, IsThatOfMostNotTheMeanOfAll) {
  const double degree = std::numbers::pi / 180.0;
  std::vector<Eigen::Vector3f> normals = walls_along(20.0 * degree, 1.0, 7);
  const std::vector<Eigen::Vector3f> askew = walls_along(0.0, 1.0, 8);
  normals.insert(normals.end(), askew.begin(), askew.begin() + 2000);
  EXPECT_NEAR(wall_direction(normals), 20.0 * degree, 0.01);
}

TEST(WallDirection, IsNoneWhereNothingStandsOut) {
  EXPECT_EQ(wall_direction(walls_along(0.3, 0.0, 6)), 0.0);
  EXPECT_EQ(wall_direction({}), 0.0);
}

}  // namespace
}  // namespace kissmap
