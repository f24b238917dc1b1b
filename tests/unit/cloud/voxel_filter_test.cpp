// SPDX-License-Identifier: MIT
#include "kissmap/cloud/voxel_filter.hpp"

#include <gtest/gtest.h>

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

TEST(VoxelFilter, KeepsTheFirstPointOfEachVoxelInOrder) {
  std::mt19937 random(11);
  VoxelFilter filter;
  std::vector<Eigen::Vector3f> kept;
  for (const std::size_t n : {0U, 1U, 500U, 60'000U, 200U}) {
    const auto points = uniform_cloud(random, n, 20.0F);
    std::set<std::tuple<int, int, int>> seen;
    std::vector<Eigen::Vector3f> expected;
    for (const Eigen::Vector3f& p : points) {
      const auto index = [](float value) { return static_cast<int>(std::floor(value / 0.5F)); };
      if (seen.insert({index(p.x()), index(p.y()), index(p.z())}).second) expected.push_back(p);
    }
    filter.apply(points, 0.5, kept);
    EXPECT_EQ(kept, expected) << n << " points";
  }
}

TEST(VoxelFilter, IsIdempotent) {
  std::mt19937 random(12);
  VoxelFilter filter;
  std::vector<Eigen::Vector3f> once;
  std::vector<Eigen::Vector3f> twice;
  filter.apply(uniform_cloud(random, 5000, 10.0F), 1.5, once);
  filter.apply(once, 1.5, twice);
  EXPECT_EQ(once, twice);
}

}  // namespace
}  // namespace kissmap
