// SPDX-License-Identifier: MIT
#include "grid/band_voxels.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace kissmap {
namespace {

constexpr int layers = 6;

CellState state_at(const GridMap& map, int x, int y) {
  const Eigen::Vector2i cell = map.cell_of(Eigen::Vector2d(x + 0.5, y + 0.5));
  return map.holds(cell.x(), cell.y()) ? map.at(cell.x(), cell.y()).state : CellState::unknown;
}

/// Length of the piece inside a box, as a share of it.
double share_inside(const BandPiece& piece,
                    const Eigen::Vector3d& low,
                    const Eigen::Vector3d& high) {
  double begin = 0.0;
  double end = 1.0;
  for (int axis = 0; axis < 3; ++axis) {
    const double way = piece.to[axis] - piece.from[axis];
    if (way == 0.0) {
      if (piece.from[axis] < low[axis] || piece.from[axis] >= high[axis]) return 0.0;
      continue;
    }
    const double a = (low[axis] - piece.from[axis]) / way;
    const double b = (high[axis] - piece.from[axis]) / way;
    begin = std::max(begin, std::min(a, b));
    end = std::min(end, std::max(a, b));
  }
  return std::max(0.0, end - begin);
}

class RandomPieces : public testing::Test {
 protected:
  BandPiece piece() {
    const auto place = [this] {
      return Eigen::Vector3d(plane_(random_), plane_(random_), up_(random_));
    };
    BandPiece piece{place(), place()};
    switch (random_() % 8) {
      case 0:
        piece.to.x() = piece.from.x();
        break;
      case 1:
        piece.to.y() = piece.from.y();
        break;
      case 2:
        piece.to.z() = piece.from.z();
        break;
      case 3:
        piece.to = {piece.from.x(), piece.from.y(), piece.to.z()};
        break;
      case 4:
        piece.from = piece.from.array().round();
        break;
      default:
        break;
    }
    return piece;
  }

  std::mt19937_64 random_{11};
  std::uniform_real_distribution<double> plane_{-40.0, 40.0};
  std::uniform_real_distribution<double> up_{-4.0, 10.0};
  ThreadPool pool_{1};
};

TEST_F(RandomPieces, FreeThoseCellsOverWhichTheyAreInTheBand) {
  for (int i = 0; i < 400; ++i) {
    const BandPiece p = piece();
    BandVoxels voxels(layers, {});
    voxels.add(std::vector<BandScan>{{{p}, {}}}, pool_);
    const GridMap map = voxels.grid(1.0, {});
    for (int x = -41; x <= 41; ++x) {
      for (int y = -41; y <= 41; ++y) {
        const double inside =
            share_inside(p, Eigen::Vector3d(x, y, 0), Eigen::Vector3d(x + 1, y + 1, layers));
        if (inside > 0.0 && inside < 1e-9) continue;  // through a corner, on either side
        const bool vertical = p.from.head<2>() == p.to.head<2>();
        const bool freed = state_at(map, x, y) == CellState::free;
        if (vertical || inside > 0.0) {
          ASSERT_EQ(freed, inside > 0.0) << i << ": " << x << " " << y;
        } else {
          // Only where the piece runs along a border may the cell beside it be freed.
          const double beside =
              share_inside(p,
                           Eigen::Vector3d(x - 1e-6, y - 1e-6, -1e-6),
                           Eigen::Vector3d(x + 1 + 1e-6, y + 1 + 1e-6, layers + 1e-6));
          ASSERT_TRUE(!freed || beside > 0.0) << i << ": " << x << " " << y;
        }
      }
    }
  }
}

TEST_F(RandomPieces, AreTheSameInAnyNumberOfPartsAndThreads) {
  BandScan whole;
  for (int i = 0; i < 500; ++i) {
    const BandPiece p = piece();
    whole.free.push_back(p);
    whole.hits.push_back(p.to);
  }
  const auto cells = [&](std::size_t parts, int threads) {
    std::vector<BandScan> divided(parts);
    for (std::size_t i = 0; i < whole.free.size(); ++i) {
      divided[i % parts].free.push_back(whole.free[i]);
      divided[i % parts].hits.push_back(whole.hits[i]);
    }
    ThreadPool pool(threads);
    BandVoxels voxels(layers, {});
    for (int scan = 0; scan < 3; ++scan) voxels.add(divided, pool);
    return voxels.grid(1.0, {}).cells;
  };
  const std::vector<GridCell> expected = cells(1, 1);
  EXPECT_EQ(cells(2, 2), expected);
  EXPECT_EQ(cells(7, 3), expected);
  EXPECT_EQ(cells(64, 8), expected);
}

TEST(BandVoxelsTest, AHitWinsOverAllRaysOfItsScan) {
  ThreadPool pool(1);
  BandVoxels voxels(layers, {});
  BandScan scan;
  for (int i = 0; i < 100; ++i) scan.free.push_back({{0.5, 0.1 + 0.008 * i, 2.5}, {9.5, 0.5, 2.5}});
  scan.hits.emplace_back(5.5, 0.5, 2.5);
  voxels.add(std::vector<BandScan>{scan}, pool);
  const GridMap map = voxels.grid(1.0, {});
  EXPECT_EQ(state_at(map, 5, 0), CellState::occupied);
  EXPECT_EQ(state_at(map, 4, 0), CellState::free);
}

TEST(BandVoxelsTest, WhatIsSeenThroughLaterIsFreeAgain) {
  ThreadPool pool(1);
  BandVoxels voxels(layers, {});
  const BandScan there{{}, {{5.5, 0.5, 2.5}}};
  const BandScan gone{{{{0.5, 0.5, 2.5}, {9.5, 0.5, 2.5}}}, {}};
  for (int i = 0; i < 1000; ++i) voxels.add(std::vector<BandScan>{there}, pool);
  EXPECT_EQ(state_at(voxels.grid(1.0, {}), 5, 0), CellState::occupied);
  // Log-odds are clamped at 0.97: twenty scans that miss are enough, however long it stood there.
  for (int i = 0; i < 20; ++i) voxels.add(std::vector<BandScan>{gone}, pool);
  EXPECT_EQ(state_at(voxels.grid(1.0, {}), 5, 0), CellState::free);
}

TEST(BandVoxelsTest, TheBandEndsExactlyWhereItEnds) {
  ThreadPool pool(1);
  const auto state = [&pool](double z) {
    BandVoxels voxels(layers, {});
    voxels.add(std::vector<BandScan>{{{}, {{3.5, 3.5, z}}}}, pool);
    return state_at(voxels.grid(1.0, {}), 3, 3);
  };
  EXPECT_EQ(state(-1e-9), CellState::unknown);
  EXPECT_EQ(state(0.0), CellState::occupied);
  EXPECT_EQ(state(layers - 1e-9), CellState::occupied);
  EXPECT_EQ(state(layers), CellState::unknown);
}

TEST(BandVoxelsTest, HighColumnsTakeSeveralWords) {
  ThreadPool pool(1);
  constexpr int high = 200;
  for (const int layer : {0, 63, 64, 127, 128, 199}) {
    BandVoxels voxels(high, {});
    voxels.add(
        std::vector<BandScan>{{{{{0.5, 0.5, 0.0}, {0.5, 0.5, high}}}, {{0.5, 0.5, layer + 0.5}}}},
        pool);
    const ColumnRule all_seen{0.5, 0.0, 1.0};
    EXPECT_EQ(state_at(voxels.grid(1.0, all_seen), 0, 0), CellState::occupied);
    const BandScan past{{{{0.5, 0.5, layer + 0.1}, {0.5, 0.5, layer + 0.9}}}, {}};
    for (int i = 0; i < 6; ++i) voxels.add(std::vector<BandScan>{past}, pool);
    EXPECT_EQ(state_at(voxels.grid(1.0, all_seen), 0, 0), CellState::free);
  }
}

TEST(BandVoxelsTest, MemoryIsAByteAVoxelOfTheTilesMet) {
  ThreadPool pool(1);
  BandVoxels voxels(layers, {});
  voxels.add(std::vector<BandScan>{{{{{0.5, 0.5, 0.5}, {63.5, 0.5, 0.5}}}, {}}}, pool);
  EXPECT_LT(voxels.memory_bytes(), 4U * 256U * layers * 11U / 10U);
}

}  // namespace
}  // namespace kissmap
