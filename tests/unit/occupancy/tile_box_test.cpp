// SPDX-License-Identifier: MIT
#include "kissmap/occupancy/tile_box.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <tuple>

#include "unit/occupancy/ray_oracle.hpp"

namespace kissmap {
namespace {

std::vector<Voxel> inside(const TileBox& box, const std::vector<Voxel>& tiles) {
  std::vector<Voxel> found;
  std::ranges::copy_if(
      tiles, std::back_inserter(found), [&box](const Voxel& tile) { return box.contains(tile); });
  return found;
}

TEST(TileBox, TheDefaultIsThePlane) {
  const TileBox all;
  EXPECT_TRUE(all.contains({0, 0, 0}));
  EXPECT_TRUE(all.contains({-max_voxel_index, max_voxel_index, 7}));
  EXPECT_EQ(intersection(all, {1, 2, 3, 4}), (TileBox{1, 2, 3, 4}));
  EXPECT_EQ(intersection({0, -3, 9, 3}, {1, -5, 8, 2}), (TileBox{1, -3, 8, 2}));
}

TEST(TileBox, IsHalvedAtTheMedianOfItsLongerSide) {
  const std::vector<Voxel> tiles{{0, 0, 0}, {1, 5, 0}, {2, 1, 0}, {9, 2, 3}};
  const auto parts = halves({}, tiles);
  ASSERT_TRUE(parts);
  EXPECT_EQ(parts->first.x_end, 2);
  EXPECT_EQ(parts->second.x_first, 2);
  EXPECT_EQ(parts->first.y_end, TileBox{}.y_end);
  const auto along_y = halves({}, std::vector<Voxel>{{0, -1, 0}, {1, 7, 0}});
  ASSERT_TRUE(along_y);
  EXPECT_EQ(along_y->first.y_end, 7);
}

TEST(TileBox, OneColumnIsNeverSplit) {
  EXPECT_FALSE(halves({}, {}));
  EXPECT_FALSE(halves({}, std::vector<Voxel>{{3, 4, 0}}));
  EXPECT_FALSE(halves({}, std::vector<Voxel>{{3, 4, 0}, {3, 4, 1}, {3, 4, -9}}));
}

TEST(TileBox, HalvesAreNeverEmptyAndShareNothing) {
  std::mt19937 random(5);
  for (int round = 0; round < 200; ++round) {
    std::vector<Voxel> tiles;
    const int n = 2 + static_cast<int>(random() % 12);
    for (int i = 0; i < n; ++i) {
      tiles.push_back(
          {static_cast<int>(random() % 5) - 2, static_cast<int>(random() % 4) - 3, i % 2});
    }
    const auto parts = halves({}, tiles);
    const bool alike = std::ranges::all_of(
        tiles, [&](const Voxel& t) { return t.x == tiles[0].x && t.y == tiles[0].y; });
    ASSERT_EQ(parts.has_value(), !alike);
    if (!parts) continue;
    const std::size_t first = inside(parts->first, tiles).size();
    const std::size_t second = inside(parts->second, tiles).size();
    ASSERT_GT(first, 0U);
    ASSERT_GT(second, 0U);
    ASSERT_EQ(first + second, tiles.size());
  }
}

TEST(TileBoxQueue, ComesToAnEndWithEveryTileOnce) {
  std::vector<Voxel> tiles;
  for (int x = -6; x < 5; ++x) {
    for (int y = 0; y < 7; ++y) tiles.push_back({x, y, 0});
  }
  TileBoxQueue queue;
  std::vector<Voxel> done;
  std::size_t parts = 0;
  while (std::optional<TileBox> box = queue.next()) {
    while (inside(*box, tiles).size() > 4) {
      box = queue.split(*box, inside(*box, tiles));
      ASSERT_TRUE(box);
    }
    const auto filled = inside(*box, tiles);
    done.insert(done.end(), filled.begin(), filled.end());
    ++parts;
  }
  EXPECT_EQ(queue.waiting(), 0U);
  EXPECT_GE(parts, tiles.size() / 4);
  const auto place = [](const Voxel& tile) { return std::tuple(tile.x, tile.y, tile.z); };
  std::ranges::sort(done, {}, place);
  std::ranges::sort(tiles, {}, place);
  EXPECT_EQ(done, tiles);
}

TEST(TileBoxQueue, KeepsNothingBackWhereABoxCannotBecomeSmaller) {
  TileBoxQueue queue;
  const TileBox box = *queue.next();
  EXPECT_FALSE(queue.split(box, std::vector<Voxel>{{0, 0, 0}}));
  EXPECT_FALSE(queue.next());
}

}  // namespace
}  // namespace kissmap
