// SPDX-License-Identifier: MIT
#include "kissmap/cloud/voxel_filter.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>
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

TEST(VoxelFilter, KeepsTheFirstPointOfEachVoxel) {
  std::mt19937 random(11);
  for (const std::size_t n : {0U, 1U, 500U, 60'000U, 200U}) {
    const auto points = uniform_cloud(random, n, 20.0F);
    std::set<std::tuple<int, int, int>> seen;
    std::vector<Eigen::Vector3f> expected;
    for (const Eigen::Vector3f& p : points) {
      const Eigen::Array3i index = (p.array() / 0.5F).floor().cast<int>();
      if (seen.insert({index.x(), index.y(), index.z()}).second) expected.push_back(p);
    }
    EXPECT_EQ(sorted(thinned(points, 0.5)), sorted(expected)) << n << " points";
  }
}

TEST(VoxelFilter, StrewsNeighboursOverTheResult) {
  // Points along a line, in order: the first half of what is kept must come from all of it.
  std::vector<Eigen::Vector3f> line;
  for (int i = 0; i < 4000; ++i) line.emplace_back(0.05F * static_cast<float>(i), 0.0F, 0.0F);
  const auto kept = thinned(line, 0.5);
  ASSERT_EQ(kept.size(), 400U);
  float sum = 0.0F;
  for (std::size_t i = 0; i < 200; ++i) sum += kept[i].x();
  EXPECT_NEAR(sum / 200.0F, 100.0F, 15.0F);
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
