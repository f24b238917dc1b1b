// SPDX-License-Identifier: MIT
#include "kissmap/cloud/crop_region.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

#include "kissmap/error.hpp"

namespace kissmap {
namespace {

TEST(CropRegion, HoldsEverythingByDefault) {
  EXPECT_TRUE(CropRegion{}.contains({1e9, -1e9, 1e9}));
}

TEST(CropRegion, BordersOfTheBoxBelongToIt) {
  CropRegion region;
  region.low = {-1.0, 2.0};
  region.high = {3.0, 4.0};
  region.z_min = -0.5;
  region.z_max = 0.5;
  EXPECT_TRUE(region.contains({-1.0, 2.0, -0.5}));
  EXPECT_TRUE(region.contains({3.0, 4.0, 0.5}));
  EXPECT_FALSE(region.contains({3.0001, 3.0, 0.0}));
  EXPECT_FALSE(region.contains({0.0, 1.9999, 0.0}));
  EXPECT_FALSE(region.contains({0.0, 3.0, 0.5001}));
  EXPECT_FALSE(region.contains({0.0, 3.0, -0.5001}));
}

/// Another way to the same answer, for outlines that do not cross themselves: the angles under
/// which a point sees the edges add up to a turn, or to nothing.
bool sees_itself_surrounded(const std::vector<Eigen::Vector2d>& polygon, const Eigen::Vector2d& p) {
  double turn = 0.0;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Eigen::Vector2d a = polygon[i] - p;
    const Eigen::Vector2d b = polygon[(i + 1) % polygon.size()] - p;
    turn += std::atan2(a.x() * b.y() - a.y() * b.x(), a.dot(b));
  }
  return std::abs(turn) > std::numbers::pi;
}

TEST(CropRegion, PolygonAgreesWithTheWindingNumberEitherWayRound) {
  std::mt19937 random(6);
  std::uniform_real_distribution<double> radius(1.0, 5.0);
  std::uniform_real_distribution<double> coordinate(-5.0, 5.0);
  for (int round = 0; round < 20; ++round) {
    CropRegion region;
    for (int i = 0; i < 3 + round; ++i) {  // a star about the origin, with reflex corners
      const double angle = 2.0 * std::numbers::pi * i / (3 + round);
      region.polygon.push_back(radius(random) * Eigen::Vector2d(std::cos(angle), std::sin(angle)));
    }
    if (round % 2 == 1) std::ranges::reverse(region.polygon);
    for (int i = 0; i < 2000; ++i) {
      const Eigen::Vector2d p(coordinate(random), coordinate(random));
      ASSERT_EQ(region.contains({p.x(), p.y(), 0.0}), sees_itself_surrounded(region.polygon, p))
          << p.transpose();
    }
  }
}

TEST(CropRegion, PolygonsSideBySideShareNoPoint) {
  CropRegion left;
  left.polygon = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
  CropRegion right;
  right.polygon = {{1, 0}, {2, 0}, {2, 1}, {1, 1}};
  for (const double y : {0.0, 0.25, 0.5}) {
    EXPECT_EQ(left.contains({1.0, y, 0.0}) + right.contains({1.0, y, 0.0}), 1);
  }
}

TEST(CropRegion, RefusesWhatHoldsNothing) {
  CropRegion region;
  region.low = {1.0, 0.0};
  region.high = {1.0, 5.0};
  EXPECT_THROW(require_valid(region), Error);
  region = {};
  region.z_min = 2.0;
  region.z_max = -2.0;
  EXPECT_THROW(require_valid(region), Error);
  region = {};
  region.polygon = {{0, 0}, {1, 1}};
  EXPECT_THROW(require_valid(region), Error);
  EXPECT_NO_THROW(require_valid(CropRegion{}));
}

}  // namespace
}  // namespace kissmap
