// SPDX-License-Identifier: MIT
#include "kissmap/evaluation/kitti_error.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "kissmap/error.hpp"
#include "kissmap/evaluation/alignment.hpp"
#include "support/random_walk.hpp"

namespace kissmap {
namespace {

/// One pose a metre, along x; each estimated metre is `scale` long and turns by `yaw` before it.
std::vector<Rigid3> line(std::size_t poses, double scale = 1.0, double yaw = 0.0) {
  const Rigid3 step = Rigid3{Eigen::Quaterniond(Eigen::AngleAxisd(yaw, Eigen::Vector3d::UnitZ())),
                             Eigen::Vector3d::Zero()} *
                      Rigid3{Eigen::Quaterniond::Identity(), {scale, 0.0, 0.0}};
  std::vector<Rigid3> way(1);
  while (way.size() < poses) way.push_back(way.back() * step);
  return way;
}

TEST(KittiError, OfWrongScaleOnALine) {
  // Steps of 1 m: the first pose more than L away is at L + 1, so the error is 0.02 (L + 1) / L.
  const KittiError error = kitti_error(line(1001), line(1001, 1.02));
  ASSERT_EQ(error.lengths.size(), 8U);
  double sum = 0.0;
  std::size_t segments = 0;
  for (const KittiMean& mean : error.lengths) {
    // Firsts 0, 10, .. up to 1000 - L - 1.
    const auto expected_segments =
        static_cast<std::size_t>((1000.0 - mean.length - 1.0) / 10.0) + 1;
    const double expected = 0.02 * (mean.length + 1.0) / mean.length;
    EXPECT_EQ(mean.segments, expected_segments);
    EXPECT_NEAR(mean.translation, expected, 1e-12);
    EXPECT_NEAR(mean.rotation, 0.0, 1e-15);
    sum += expected * static_cast<double>(expected_segments);
    segments += expected_segments;
  }
  EXPECT_EQ(error.overall.segments, segments);
  EXPECT_NEAR(error.overall.translation, sum / static_cast<double>(segments), 1e-12);
}

TEST(KittiError, OfYawDriftOnALine) {
  constexpr double yaw = 1e-3;  // rad/m
  const KittiError error = kitti_error(line(501), line(501, 1.0, yaw), {{100, 200}, 10});
  for (const KittiMean& mean : error.lengths) {
    const double n = mean.length + 1.0;
    EXPECT_NEAR(mean.rotation, yaw * n / mean.length, 1e-12);
    // End of a chain of n unit steps, the k-th turned by k * yaw, against n straight ones, seen
    // from the end of the chain: its length does not depend on where it is seen from.
    const double half = 0.5 * n * yaw;
    const double chord = std::sin(half) / std::sin(0.5 * yaw);
    const double direction = 0.5 * (n + 1.0) * yaw;
    const double expected =
        std::hypot(chord * std::cos(direction) - n, chord * std::sin(direction));
    EXPECT_NEAR(mean.translation, expected / mean.length, 1e-9);
  }
}

TEST(KittiError, OfTheTruthIsZeroInAnyFrame) {
  const std::vector<Rigid3> way = winding_way(1200, 0.5);
  const Rigid3 moved = exp((Twist() << 30.0, -50.0, 7.0, 0.4, -1.2, 2.0).finished());
  const KittiError error = kitti_error(way, transformed(moved, way));
  EXPECT_GT(error.overall.segments, 100U);
  EXPECT_NEAR(error.overall.translation, 0.0, 1e-13);
  EXPECT_NEAR(error.overall.rotation, 0.0, 1e-13);
}

TEST(KittiError, WithoutALongEnoughWayHasNoSegments) {
  const KittiError error = kitti_error(line(50), line(50));
  EXPECT_EQ(error.overall.segments, 0U);
  EXPECT_EQ(kitti_error({}, {}).overall.segments, 0U);
  // At 100 m exactly there is no pose beyond.
  EXPECT_EQ(kitti_error(line(101), line(101)).overall.segments, 0U);
  EXPECT_EQ(kitti_error(line(102), line(102)).overall.segments, 1U);
}

TEST(KittiError, LengthsFitTheWay) {
  EXPECT_EQ(kitti_lengths_for(5000.0), KittiOptions{}.lengths);
  EXPECT_EQ(kitti_lengths_for(150.0).back(), 10.0);
  EXPECT_EQ(kitti_lengths_for(3.0).front(), 0.1);
}

TEST(KittiError, RefusesImpossibleOptions) {
  for (const KittiOptions& options : {KittiOptions{{}, 10},
                                      KittiOptions{{0.0}, 10},
                                      KittiOptions{{1.0}, 0},
                                      KittiOptions{{std::nan("")}, 10}}) {
    EXPECT_THROW(kitti_error(line(5), line(5), options), Error);
  }
}

}  // namespace
}  // namespace kissmap
