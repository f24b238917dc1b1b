// SPDX-License-Identifier: MIT
#include "kissmap/loop_closing/place_search.hpp"

#include <gtest/gtest.h>

#include "kissmap/loop_closing/density_image.hpp"
#include "kissmap/loop_closing/ground_alignment.hpp"
#include "support/block_world.hpp"
#include "support/matchers.hpp"

namespace kissmap {
namespace {

TEST(DensityImage, CountsPointsOverEachPixel) {
  const std::vector<Eigen::Vector3f> points = {{0.1F, 0.1F, 0.0F},
                                               {0.2F, 0.3F, 5.0F},
                                               {0.4F, 0.4F, 9.0F},
                                               {0.1F, 0.4F, 1.0F},
                                               {1.2F, 0.7F, 0.0F}};
  const DensityImage image = density_image(points, Rigid3{}, 0.5, 100);
  ASSERT_EQ(image.width, 3);
  ASSERT_EQ(image.height, 2);
  EXPECT_EQ(image.corner, Eigen::Vector2d(0.0, 0.0));
  EXPECT_EQ(image.pixels, (std::vector<std::uint8_t>{255, 0, 0, 0, 0, 64}));  // 4 and 1 of 4
}

TEST(DensityImage, LeavesOutFaintPixelsAndRefusesHugeOnes) {
  std::vector<Eigen::Vector3f> points(100, Eigen::Vector3f(0.1F, 0.1F, 0.0F));
  points.emplace_back(3.0F, 0.0F, 0.0F);
  const DensityImage image = density_image(points, Rigid3{}, 0.5, 100);
  EXPECT_EQ(image.pixels.front(), 255);
  EXPECT_EQ(image.pixels.back(), 0) << "one of a hundred is below 0.05";
  EXPECT_TRUE(density_image(points, Rigid3{}, 0.5, 6).empty());
  EXPECT_TRUE(density_image({}, Rigid3{}, 0.5, 100).empty());
}

TEST(PlaceFeatures, EmptyAndFeaturelessImagesHaveNone) {
  EXPECT_EQ(place_features(DensityImage{}).size(), 0U);
  const DensityImage blank{200, 100, 0.5, {0.0, 0.0}, std::vector<std::uint8_t>(20000, 120)};
  const PlaceFeatures features = place_features(blank);
  // The corners of the picture itself are all there is; they look alike and are dropped.
  EXPECT_LE(features.size(), 4U);
}

TEST(GroundAlignment, LevelsATiltedGround) {
  Rigid3 tilted;
  tilted.rotation = Eigen::AngleAxisd(0.12, Eigen::Vector3d(0.6, 0.8, 0.0));
  tilted.translation = {0.0, 0.0, -1.7};
  const std::vector<Eigen::Vector3f> world = block_world(3);
  const auto ground = ground_from_local_map(moved(tilted, world));
  ASSERT_TRUE(ground);
  const Rigid3 level = *ground * tilted;
  const Eigen::Vector3d up = level.rotation * Eigen::Vector3d::UnitZ();
  EXPECT_LT(std::acos(std::min(1.0, up.z())), 0.01);
  EXPECT_NEAR(level.translation.z(), 0.0, 0.1);
}

TEST(GroundAlignment, SaysWhenThereIsNone) {
  EXPECT_FALSE(ground_from_local_map({}));
  EXPECT_FALSE(ground_from_local_map(std::vector<Eigen::Vector3f>(500, {1.0F, 1.0F, 1.0F})));
}

class AnyTurn : public testing::TestWithParam<double> {};

TEST_P(AnyTurn, FindsAPlaceSeenBefore) {
  PlaceSearch search(PlaceSearchOptions{});
  for (std::uint32_t id = 0; id < 6; ++id) {
    EXPECT_TRUE(search.add(id, block_world(id)).empty()) << "six worlds, no two alike";
  }
  const Rigid3 query_from_reference = planar_motion(4.3, -2.7, GetParam());
  const auto candidates = search.add(6, moved(query_from_reference, block_world(1)));
  ASSERT_FALSE(candidates.empty());
  EXPECT_EQ(candidates[0].id, 1U);
  EXPECT_GT(candidates[0].inliers, 10);
  EXPECT_THAT(candidates[0].reference_from_query,
              PoseNear(query_from_reference.inverse(), 0.7, 0.03));
}

INSTANTIATE_TEST_SUITE_P(Degrees, AnyTurn, testing::Values(0.0, 17.0, 45.0, 90.0, 133.0, 180.0));

TEST(PlaceSearch, SkipsTheLatestAndOutlivesEmptyMaps) {
  PlaceSearch search(PlaceSearchOptions{});
  const auto world = block_world(1);
  EXPECT_TRUE(search.add(0, {}).empty());
  EXPECT_TRUE(search.add(1, world).empty());
  for (std::uint32_t id = 2; id < 5; ++id) {
    EXPECT_TRUE(search.add(id, world).empty()) << "1 is among the three before " << id;
  }
  const auto candidates = search.add(5, world);
  ASSERT_EQ(candidates.size(), 2U) << "at both scales";
  EXPECT_EQ(candidates[0].id, 1U);
  EXPECT_EQ(candidates[1].id, 1U);
}

}  // namespace
}  // namespace kissmap
