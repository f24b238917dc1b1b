// SPDX-License-Identifier: MIT
#include "grid/column_projection.hpp"

#include <gtest/gtest.h>

#include <map>
#include <random>

namespace kissmap {
namespace {

constexpr int layers = 11;

OccupancyMap random_map(std::uint64_t seed) {
  OccupancyMap voxels({Eigen::Vector3d::Zero(), {0.1, 0.1, 0.07}, LayerRange{0, layers - 1}});
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<float> plane(-5.0F, 4.0F);
  std::uniform_real_distribution<float> up(-1.0F, 2.0F);
  ThreadPool pool(1);
  for (int scan = 0; scan < 20; ++scan) {
    std::vector<Eigen::Vector3f> starts;
    std::vector<Eigen::Vector3f> ends;
    for (int ray = 0; ray < 40; ++ray) {
      starts.emplace_back(plane(random), plane(random), up(random));
      ends.emplace_back(plane(random), plane(random), up(random));
    }
    RayScan rays;
    rays.starts = starts;
    rays.ends = ends;
    voxels.add(rays, pool);
  }
  return voxels;
}

TEST(ColumnProjection, JudgesEachColumnByItsVoxels) {
  const OccupancyMap voxels = random_map(3);
  for (const ColumnRule& rule : {ColumnRule{}, ColumnRule{0.7, 0.9, 0.2}}) {
    std::map<std::pair<int, int>, ColumnCounts> columns;
    voxels.for_each_voxel([&](const Voxel& voxel, LogOdds value) {
      ColumnCounts& column = columns[{voxel.x, voxel.y}];
      const double probability = voxels.steps().probability(value);
      ++column.seen;
      column.free += probability < std::min(rule.threshold, 0.5) ? 1 : 0;
      column.highest = std::max(column.highest, static_cast<float>(probability));
    });
    const GridMap map = project_columns(voxels, rule);
    std::size_t known = 0;
    for (int y = 0; y < map.height; ++y) {
      for (int x = 0; x < map.width; ++x) {
        const Eigen::Vector2d middle = map.corner + 0.1 * Eigen::Vector2d(x + 0.5, y + 0.5);
        const Voxel voxel = *voxel_at(voxels.geometry(), {middle.x(), middle.y(), 0.01});
        const auto found = columns.find({voxel.x, voxel.y});
        const ColumnCounts column = found == columns.end() ? ColumnCounts{} : found->second;
        ASSERT_EQ(map.at(x, y), judge_column(column, layers, rule)) << x << " " << y;
        known += column.seen > 0 ? 1U : 0U;
      }
    }
    EXPECT_EQ(known, columns.size()) << "no column lies outside the map";
    EXPECT_GT(known, 1000U);
  }
}

TEST(ColumnProjection, NothingSeenIsNoMap) {
  const OccupancyMap voxels({Eigen::Vector3d::Zero(), {0.1, 0.1, 0.1}, LayerRange{0, 3}});
  EXPECT_TRUE(project_columns(voxels, {}).cells.empty());
}

}  // namespace
}  // namespace kissmap
