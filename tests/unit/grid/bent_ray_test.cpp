// SPDX-License-Identifier: MIT
#include "grid/bent_ray.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace kissmap {
namespace {

FloorMap floor_of(double (*height)(double x, double y)) {
  constexpr double cell = 0.25;
  constexpr int cells = 320;
  std::vector<float> z;
  for (int y = 0; y < cells; ++y) {
    for (int x = 0; x < cells; ++x) {
      z.push_back(static_cast<float>(height((x + 0.5) * cell - 40.0, (y + 0.5) * cell - 40.0)));
    }
  }
  return {{-40.0, -40.0}, cell, cells, cells, z};
}

double hills(double x, double y) {
  return 1.5 * std::sin(0.15 * x) + 0.8 * std::cos(0.2 * y);
}

double ramp(double x, double /*y*/) {
  return 0.176 * std::clamp(x, 0.0, 12.0);
}

/// Largest height by which the bent ray is off where the straight one truly is.
double largest_error(const FloorMap& floor, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> place(-35.0, 35.0);
  std::uniform_real_distribution<double> up(-1.0, 4.0);
  std::vector<Eigen::Vector3d> corners;
  double worst = 0.0;
  for (int ray = 0; ray < 300; ++ray) {
    const Eigen::Vector3d start(place(random), place(random), up(random));
    const Eigen::Vector3d end(place(random), place(random), up(random));
    bend_ray(start, end, floor, corners);
    const double length = (end - start).head<2>().norm();
    EXPECT_EQ(corners.front().head<2>(), start.head<2>());
    EXPECT_EQ(corners.back().head<2>(), end.head<2>());
    std::size_t piece = 0;
    for (int i = 0; i <= 200; ++i) {
      const Eigen::Vector3d truth = start + (end - start) * i / 200.0;
      const double along = length * i / 200.0;
      const auto reach = [&](std::size_t k) { return (corners[k] - corners[0]).head<2>().norm(); };
      while (piece + 2 < corners.size() && reach(piece + 1) < along) ++piece;
      const double share = (along - reach(piece)) / (reach(piece + 1) - reach(piece));
      const double bent =
          corners[piece].z() + share * (corners[piece + 1].z() - corners[piece].z());
      const double expected = truth.z() - floor.height(truth.x(), truth.y());
      worst = std::max(worst, std::abs(bent - expected));
    }
  }
  return worst;
}

TEST(BentRay, FollowsHillsAndRamps) {
  EXPECT_LT(largest_error(floor_of(hills), 1), 0.02);
  EXPECT_LT(largest_error(floor_of(ramp), 2), 0.02);
}

TEST(BentRay, IsStraightOverALevelFloor) {
  std::vector<Eigen::Vector3d> corners;
  bend_ray({1.0, 2.0, 3.0}, {9.0, -2.0, 0.5}, FloorMap(), corners);
  ASSERT_EQ(corners.size(), 2U);
  EXPECT_EQ(corners[0], Eigen::Vector3d(1.0, 2.0, 3.0));
  EXPECT_EQ(corners[1], Eigen::Vector3d(9.0, -2.0, 0.5));
}

TEST(BentRay, UpAndDownIsOnePiece) {
  std::vector<Eigen::Vector3d> corners;
  const FloorMap floor = floor_of(hills);
  bend_ray({1.0, 2.0, 3.0}, {1.0, 2.0, 0.5}, floor, corners);
  ASSERT_EQ(corners.size(), 2U);
  EXPECT_NEAR(corners[0].z() - corners[1].z(), 2.5, 1e-12);
}

}  // namespace
}  // namespace kissmap
