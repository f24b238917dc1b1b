// SPDX-License-Identifier: MIT
#include "kissmap/cloud/voxel_filter.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <tuple>

#include "support/random_clouds.hpp"

namespace kissmap {
namespace {

TEST(VoxelKey, RoundTripsNegativeAndExtremeIndices) {
  for (const std::int32_t a : {-(1 << 20), -1, 0, 1, 12345, (1 << 20) - 1}) {
    const Voxel voxel{a, -a - 1, a ^ 7};
    EXPECT_EQ(voxel_from_key(voxel_key(voxel)), voxel);
  }
}

std::vector<Eigen::Vector3f> thinned(const std::vector<Eigen::Vector3f>& points,
                                     double voxel_size,
                                     VoxelFilter filter = {}) {
  std::vector<Eigen::Vector3f> kept;
  filter.apply(points, voxel_size, kept);
  return kept;
}

std::vector<Eigen::Vector3f> sorted(std::vector<Eigen::Vector3f> points) {
  std::ranges::sort(points, [](const Eigen::Vector3f& a, const Eigen::Vector3f& b) {
    return std::lexicographical_compare(a.begin(), a.end(), b.begin(), b.end());
  });
  return points;
}

TEST(VoxelFilter, KeepsThePointNearestTheCentreOfEachVoxel) {
  std::mt19937 random(11);
  for (const std::size_t n : {0U, 1U, 500U, 60'000U, 200U}) {
    const auto points = uniform_cloud(random, n, 20.0F);
    std::map<std::tuple<int, int, int>, std::pair<double, Eigen::Vector3f>> nearest;
    for (const Eigen::Vector3f& p : points) {
      const Eigen::Array3i index = (p.array() / 0.5F).floor().cast<int>();
      const double distance =
          ((p.array() / 0.5F).cast<double>() - index.cast<double>() - 0.5).matrix().norm();
      const auto [it, added] = nearest.try_emplace({index.x(), index.y(), index.z()}, distance, p);
      if (distance < it->second.first - 1e-5) it->second = {distance, p};
    }
    std::vector<Eigen::Vector3f> expected;
    for (const auto& item : nearest) expected.push_back(item.second.second);
    EXPECT_EQ(sorted(thinned(points, 0.5)), sorted(expected)) << n << " points";
  }
}

TEST(VoxelFilter, KeepsTheSamePointsInWhateverOrderTheyCome) {
  std::mt19937 random(12);
  auto points = uniform_cloud(random, 30'000, 15.0F);
  const auto kept = sorted(thinned(points, 0.5));
  std::ranges::shuffle(points, random);
  EXPECT_EQ(sorted(thinned(points, 0.5)), kept);
}

TEST(VoxelFilter, RemembersNothingOfEarlierClouds) {
  std::mt19937 random(13);
  const auto points = uniform_cloud(random, 3000, 10.0F);
  VoxelFilter used;
  std::vector<Eigen::Vector3f> other;
  used.apply(uniform_cloud(random, 100'000, 60.0F), 0.5, other);
  EXPECT_EQ(thinned(points, 0.5, used), thinned(points, 0.5));
}

TEST(VoxelFilter, IsIdempotent) {
  std::mt19937 random(14);
  const auto once = thinned(uniform_cloud(random, 5000, 10.0F), 1.5);
  EXPECT_EQ(sorted(thinned(once, 1.5)), sorted(once));
}

}  // namespace
}  // namespace kissmap
