// SPDX-License-Identifier: MIT
#include "kissmap/grid/grid_map.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "kissmap/error.hpp"

namespace kissmap {
namespace {

/// '#' occupied, '.' free, ' ' unknown; the first row is the highest y.
GridMap map_of(const std::vector<std::string>& rows) {
  GridMap map;
  map.resolution = 0.5;
  map.corner = {-3.0, 2.0};
  map.width = static_cast<int>(rows.front().size());
  map.height = static_cast<int>(rows.size());
  map.cells.resize(rows.size() * rows.front().size());
  for (int y = 0; y < map.height; ++y) {
    for (int x = 0; x < map.width; ++x) {
      const char c =
          rows[rows.size() - 1 - static_cast<std::size_t>(y)][static_cast<std::size_t>(x)];
      if (c == '#') map.at(x, y) = {CellState::occupied, 0.9F};
      if (c == '.') map.at(x, y) = {CellState::free, 0.2F};
    }
  }
  return map;
}

std::vector<std::string> rows_of(const GridMap& map) {
  std::vector<std::string> rows;
  for (int y = map.height - 1; y >= 0; --y) {
    std::string row;
    for (int x = 0; x < map.width; ++x) row += " .#"[static_cast<int>(map.at(x, y).state)];
    rows.push_back(row);
  }
  return rows;
}

using Rows = std::vector<std::string>;

TEST(ColumnRule, OneOccupiedVoxelDecides) {
  EXPECT_EQ(judge_column({4, 3, 0.8F}, 5, {}), (GridCell{CellState::occupied, 0.8F}));
}

TEST(ColumnRule, AnUnseenVoxelHidesNoFreeColumn) {
  const ColumnCounts column{2, 2, 0.3F};
  EXPECT_EQ(judge_column(column, 4, {}), (GridCell{CellState::free, 0.3F}));
  EXPECT_EQ(judge_column(column, 4, {0.5, 0.5, 0.6}).state, CellState::unknown) << "half is seen";
  EXPECT_EQ(judge_column(column, 4, {0.5, 0.5, 0.5}).state, CellState::free);
}

TEST(ColumnRule, NothingSeenIsUnknown) {
  EXPECT_EQ(judge_column({}, 2, {}), GridCell{});
}

TEST(ColumnRule, UndecidedVoxelsAreNotFree) {
  const ColumnCounts column{3, 1, 0.5F};
  EXPECT_EQ(judge_column(column, 3, {}).state, CellState::unknown) << "a third is free";
  EXPECT_EQ(judge_column(column, 3, {0.5, 0.3, 0.0}).state, CellState::free);
}

TEST(ColumnRule, ImpossibleSharesAreRefused) {
  EXPECT_THROW(require_valid(ColumnRule{1.5, 0.5, 0.0}), Error);
  EXPECT_THROW(require_valid(ColumnRule{0.5, -0.1, 0.0}), Error);
  EXPECT_THROW(require_valid(ColumnRule{0.5, 0.5, std::nan("")}), Error);
  EXPECT_NO_THROW(require_valid(ColumnRule{}));
}

TEST(GridMapTest, SmallGroupsBecomeWhatIsAroundThem) {
  GridMap map = map_of({"......", ".#...#", "....#.", "  ....", "# ....", "  .###"});
  EXPECT_EQ(remove_small_groups(3, map), 4U);
  EXPECT_EQ(rows_of(map), (Rows{"......", "......", "......", "  ....", "  ....", "  .###"}));
  EXPECT_EQ(remove_small_groups(0, map), 0U);
}

TEST(GridMapTest, SmallGroupsThatAreWellSeenStay) {
  GridMap map = map_of({".....", ".#.#.", "..#..", ".....", ".#...", "....#"});
  map.at(1, 1).probability = 0.7F;  // the fifth row
  map.at(4, 0).probability = 0.75F;
  map.at(1, 4).probability = 0.7F;  // one of a group of three, the others 0.9
  EXPECT_EQ(remove_small_groups(4, map, 0.71), 1U);
  EXPECT_EQ(rows_of(map), (Rows{".....", ".#.#.", "..#..", ".....", ".....", "....#"}));
}

TEST(GridMapTest, FreeSpaceBehindWallsIsNotConnected) {
  GridMap map = map_of({"..#..", "..#..", "..###", ".#...", "#...."});
  // The last two rows are reached from the path; corners alone do not connect.
  const std::vector<Eigen::Vector2d> path = {{-3.0 + 2.2, 2.0 + 0.3}, {100.0, 100.0}};
  EXPECT_EQ(keep_connected_free(path, map), 11U);
  EXPECT_EQ(rows_of(map), (Rows{"  #  ", "  #  ", "  ###", " #...", "#...."}));
}

TEST(GridMapTest, CroppingKeepsPlaces) {
  const GridMap map = map_of({"..#", ".#.", "#.."});
  const GridMap part = cropped(map, {Eigen::Vector2d(-2.6, 2.5), Eigen::Vector2d(-1.5, 4.2)});
  EXPECT_EQ(rows_of(part), (Rows{"   ", "   ", "..#", ".#."})) << "from 2.5 to 4.5";
  EXPECT_EQ(part.corner, Eigen::Vector2d(-3.0, 2.5));
  for (int y = 0; y < 2; ++y) {
    for (int x = 0; x < 3; ++x) {
      const Eigen::Vector2d middle = part.corner + Eigen::Vector2d(x + 0.5, y + 0.5) * 0.5;
      const Eigen::Vector2i there = map.cell_of(middle);
      EXPECT_EQ(part.at(x, y), map.at(there.x(), there.y()));
    }
  }
}

TEST(GridMapTest, TrimmingLeavesTheMargin) {
  const GridMap map = map_of({"     ", "  #  ", "  .. ", "     ", "     "});
  EXPECT_EQ(rows_of(trimmed(map, 0)), (Rows{"# ", ".."}));
  EXPECT_EQ(rows_of(trimmed(map, 1)), (Rows{"    ", " #  ", " .. ", "    "}));
  EXPECT_EQ(trimmed(map_of({"  ", "  "}), 1).cells.size(), 0U);
}

TEST(GridMap, JoinedMapsKnowWhatEitherKnows) {
  GridMap west = map_of({"#..", ".# "});
  GridMap east = map_of({"#.", "..", "##"});
  east.corner += Eigen::Vector2d(1.0, -0.5);  // two cells to the east, one to the south
  const GridMap both = joined(west, east);
  EXPECT_EQ(both.corner, Eigen::Vector2d(-3.0, 1.5));
  EXPECT_EQ(rows_of(both), (std::vector<std::string>{"#.#.", ".#..", "  ##"}));
  EXPECT_EQ(rows_of(joined(GridMap{}, west)), rows_of(west));
  EXPECT_EQ(rows_of(joined(west, GridMap{})), rows_of(west));
}

}  // namespace
}  // namespace kissmap
