// SPDX-License-Identifier: MIT
// 2D maps, read back by a program that knows only the rules of the map servers.
#include "kissmap/formats/grid_files.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <random>
#include <sstream>

#include "kissmap/error.hpp"
#include "support/program.hpp"
#include "support/temp_dir.hpp"

namespace kissmap {
namespace {

namespace fs = std::filesystem;
using testing::ElementsAre;

struct LoadedMap {
  int width = 0;
  int height = 0;
  double resolution = 0.0;
  double x = 0.0;
  double y = 0.0;
  double yaw = 0.0;
  std::vector<int> cells;  ///< from the lowest row up
};

LoadedMap load(const fs::path& yaml, const std::string& loader) {
  const ProgramResult result = run_program(
      {KISSMAP_TEST_PYTHON, std::string(KISSMAP_TEST_SOURCES) + "/load_map.py", yaml, loader});
  EXPECT_EQ(result.exit_code, 0) << result.err;
  std::istringstream text(result.out);
  LoadedMap map;
  text >> map.width >> map.height >> map.resolution >> map.x >> map.y >> map.yaw;
  for (int value = 0; text >> value;) map.cells.push_back(value);
  return map;
}

/// Not square, with negative origin, no two rows or columns alike.
GridMap example_map() {
  GridMap map;
  map.resolution = 0.05;
  map.corner = {-12.35, -3.7};
  map.width = 37;
  map.height = 23;
  std::mt19937 random(4);
  for (int i = 0; i < map.width * map.height; ++i) {
    const auto state = static_cast<CellState>(random() % 3);
    const float share = static_cast<float>(random() % 1000) / 1000.0F;
    GridCell cell;
    if (state == CellState::free) cell = {state, 0.12F + 0.38F * share};
    if (state == CellState::occupied) cell = {state, 0.5F + 0.47F * share};
    map.cells.push_back(cell);
  }
  return map;
}

class GridFiles : public testing::TestWithParam<const char*> {
 protected:
  fs::path stem() const { return folder_.path() / "map \"1\""; }
  fs::path yaml() const { return folder_.path() / "map \"1\".yaml"; }
  TempDir folder_;
};

TEST_P(GridFiles, TrinaryMapsLoadAsTheyWere) {
  const GridMap map = example_map();
  write_grid(map, GridMode::trinary, stem(), {"a comment"});
  const LoadedMap loaded = load(yaml(), GetParam());
  EXPECT_EQ(loaded.width, map.width);
  EXPECT_EQ(loaded.height, map.height);
  EXPECT_EQ(loaded.resolution, 0.05);
  EXPECT_EQ(loaded.x, -12.35);
  EXPECT_EQ(loaded.y, -3.7);
  EXPECT_EQ(loaded.yaw, 0.0);
  ASSERT_EQ(loaded.cells.size(), map.cells.size());
  for (std::size_t i = 0; i < map.cells.size(); ++i) {
    const int expected = map.cells[i].state == CellState::occupied ? 100
                         : map.cells[i].state == CellState::free   ? 0
                                                                   : -1;
    ASSERT_EQ(loaded.cells[i], expected) << i;
  }
}

TEST_P(GridFiles, GradedMapsLoadInTheirOrder) {
  const GridMap map = example_map();
  write_grid(map, GridMode::scale, stem());
  const LoadedMap loaded = load(yaml(), GetParam());
  ASSERT_EQ(loaded.cells.size(), map.cells.size());
  for (std::size_t i = 0; i < map.cells.size(); ++i) {
    const GridCell& cell = map.cells[i];
    if (cell.state == CellState::unknown) {
      ASSERT_EQ(loaded.cells[i], -1) << i;
      continue;
    }
    const double share =
        std::clamp((static_cast<double>(cell.probability) - 0.196) / (0.65 - 0.196), 0.0, 1.0);
    // A pixel is 1/255 of probability, the loaders' steps are whole percents.
    ASSERT_NEAR(loaded.cells[i], 100.0 * share, 2.5) << i << ": " << cell.probability;
  }
}

INSTANTIATE_TEST_SUITE_P(Loaders, GridFiles, testing::Values("ros1", "nav2"));

TEST(GridFileNames, AreThoseWritten) {
  const TempDir folder;
  write_grid(example_map(), GridMode::trinary, folder.path() / "a");
  for (const fs::path& path : grid_file_paths(folder.path() / "a", GridMode::trinary)) {
    EXPECT_TRUE(fs::exists(path)) << path;
  }
  write_grid(example_map(), GridMode::scale, folder.path() / "b.1");
  EXPECT_THAT(grid_file_paths(folder.path() / "b.1", GridMode::scale),
              ElementsAre(folder.path() / "b.1.png", folder.path() / "b.1.yaml"));
  EXPECT_TRUE(fs::exists(folder.path() / "b.1.png"));
}

TEST(GridFileNames, AMapWithoutCellsIsRefused) {
  const TempDir folder;
  EXPECT_THROW(write_grid({}, GridMode::trinary, folder.path() / "a"), Error);
  EXPECT_TRUE(fs::is_empty(folder.path()));
}

TEST(GridPicture, IsTheMapEnlargedOrMadeSmaller) {
  const GridMap map = example_map();
  const Picture picture = draw_grid(map, {{{-12.0, -3.5}, {-11.0, -3.0}}});
  EXPECT_GT(picture.width, 800);
  GridMap large;
  large.width = 5000;
  large.height = 100;
  large.cells.resize(500'000);
  const Picture small = draw_grid(large, {}, 1000);
  EXPECT_LE(small.width, 1100);
  EXPECT_EQ(small.rgb.size(), 3U * static_cast<std::size_t>(small.width * small.height));
}

TEST(GridPicture, StretchesAreDrawnApart) {
  GridMap map;
  map.width = 200;
  map.height = 100;
  map.cells.resize(20'000);  // 10 x 5 m
  const auto middle = [&map](const std::vector<PlanPath>& stretches) {
    const Picture picture = draw_grid(map, stretches);
    const auto row = static_cast<std::size_t>(16 + (picture.height - 48) / 2);
    const auto column = static_cast<std::size_t>(picture.width / 2);
    const std::uint8_t* pixel =
        &picture.rgb[3 * (row * static_cast<std::size_t>(picture.width) + column)];
    return std::vector<int>(pixel, pixel + 3);
  };
  const PlanPath left = {{1.0, 2.5}, {2.0, 2.5}};
  const PlanPath right = {{8.0, 2.5}, {9.0, 2.5}};
  EXPECT_EQ(middle({left, right}), middle({}));
  EXPECT_NE(middle({{left[0], left[1], right[0], right[1]}}), middle({}));
}

}  // namespace
}  // namespace kissmap
