// SPDX-License-Identifier: MIT
#include "kissmap/mapping/surfels.hpp"

#include <gtest/gtest.h>

#include "support/random_clouds.hpp"

namespace kissmap {
namespace {

TEST(Surfels, OfAPlaneLieInItAndPointToTheOrigin) {
  // The plane x + 2 y + 2 z = 9, unit normal (1,2,2)/3, distance 3 from the origin.
  const Eigen::Vector3f normal(1.0F / 3, 2.0F / 3, 2.0F / 3);
  const Eigen::Vector3f u = normal.unitOrthogonal();
  const Eigen::Vector3f v = normal.cross(u);
  std::mt19937 random(51);
  std::uniform_real_distribution<float> range(-6.0F, 6.0F);
  std::vector<Eigen::Vector3f> points;
  for (int i = 0; i < 20'000; ++i) {
    points.push_back(3.0F * normal + range(random) * u + range(random) * v);
  }
  VoxelHashMap grid(0.5, 20);
  grid.add(points);
  const SurfelCloud surfels = surfels_from_grid(grid);
  ASSERT_GT(surfels.size(), 300U);
  ASSERT_EQ(surfels.normals.size(), surfels.means.size());
  for (std::size_t i = 0; i < surfels.size(); ++i) {
    EXPECT_NEAR(surfels.means[i].dot(normal), 3.0F, 1e-4F);
    EXPECT_NEAR(surfels.normals[i].norm(), 1.0F, 1e-5F);
  }
  // A voxel cut at its corner may hold three points nearly in a line; most normals must agree.
  const auto agreeing = std::ranges::count_if(
      surfels.normals, [&](const Eigen::Vector3f& n) { return n.dot(normal) < -0.999F; });
  EXPECT_GT(agreeing, static_cast<std::ptrdiff_t>(0.97 * static_cast<double>(surfels.size())));
}

TEST(Surfels, NeedThreePoints) {
  VoxelHashMap grid(0.5, 20);
  grid.add(std::vector<Eigen::Vector3f>{{0.1F, 0.1F, 0.1F}, {0.3F, 0.1F, 0.1F}, {5, 5, 5}});
  EXPECT_EQ(surfels_from_grid(grid).size(), 0U);
  grid.add(std::vector<Eigen::Vector3f>{{0.1F, 0.4F, 0.1F}});
  const SurfelCloud surfels = surfels_from_grid(grid);
  ASSERT_EQ(surfels.size(), 1U);
  EXPECT_TRUE(surfels.means[0].isApprox(Eigen::Vector3f(0.5F / 3, 0.2F, 0.1F), 1e-5F));
}

}  // namespace
}  // namespace kissmap
