// SPDX-License-Identifier: MIT
#include "kissmap/cloud/outliers.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "support/random_clouds.hpp"

namespace kissmap {
namespace {

/// The definition, comparing every point with every other one.
std::vector<std::uint32_t> by_brute_force(const std::vector<Eigen::Vector3f>& points,
                                          const OutlierOptions& options) {
  std::vector<double> distances;
  for (const Eigen::Vector3f& p : points) {
    std::vector<double> to_others;
    for (const Eigen::Vector3f& q : points) to_others.push_back((p - q).cast<double>().norm());
    std::ranges::sort(to_others);
    double sum = 0.0;  // the nearest is the point itself
    for (int k = 1; k <= options.neighbors; ++k) sum += to_others[static_cast<std::size_t>(k)];
    distances.push_back(sum / options.neighbors);
  }
  const auto n = static_cast<double>(points.size());
  double mean = 0.0;
  for (const double d : distances) mean += d / n;
  double variance = 0.0;
  for (const double d : distances) variance += (d - mean) * (d - mean) / (n - 1.0);
  std::vector<std::uint32_t> inliers;
  for (std::uint32_t i = 0; i < points.size(); ++i) {
    if (distances[i] <= mean + options.max_deviations * std::sqrt(variance)) inliers.push_back(i);
  }
  return inliers;
}

TEST(Outliers, AreThoseTheDefinitionSays) {
  std::mt19937 random(12);
  std::vector<Eigen::Vector3f> points = room_cloud(random, 1500);
  const std::vector<Eigen::Vector3f> stray = uniform_cloud(random, 60, 25.0F);
  points.insert(points.begin() + 700, stray.begin(), stray.end());
  for (const double deviations : {0.5, 2.0}) {
    OutlierOptions options;
    options.max_deviations = deviations;
    const std::vector<std::uint32_t> wanted = by_brute_force(points, options);
    EXPECT_LT(wanted.size(), points.size());
    EXPECT_EQ(find_inliers(points, options), wanted);
  }
}

TEST(Outliers, FewPointsAllStay) {
  EXPECT_TRUE(find_inliers({}).empty());
  const std::vector<Eigen::Vector3f> one(1, Eigen::Vector3f::Zero());
  EXPECT_EQ(find_inliers(one).size(), 1U);
  const std::vector<Eigen::Vector3f> same(50, Eigen::Vector3f::Ones());
  EXPECT_EQ(find_inliers(same).size(), 50U) << "all equal";
}

}  // namespace
}  // namespace kissmap
