// SPDX-License-Identifier: MIT
// Maps of a room and a ramp whose walls are known, by rays cast here.
#include "kissmap/grid/band_mapper.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <utility>

#include "kissmap/error.hpp"

namespace kissmap {
namespace {

/// z of a place's floor.
using Floor = double (*)(double x);

double level(double /*x*/) {
  return 0.0;
}
double ramp(double x) {
  return 0.176 * x;  // 10 degrees
}

FloorMap floor_map(Floor floor) {
  std::vector<float> z;
  for (int y = 0; y < 80; ++y) {
    for (int x = 0; x < 120; ++x) z.push_back(static_cast<float>(floor((x + 0.5) * 0.25 - 15.0)));
  }
  return {{-15.0, -10.0}, 0.25, 120, 80, z};
}

/// The place: walls at x = +-9.02 and y = +-5.02, 3 m high above the floor, and a step from the
/// floor up to 0.15 m at x in [4, 5], y in [-1, 1]. Rays are followed in steps of 2 mm.
bool is_solid(const Eigen::Vector3d& p, Floor floor) {
  const double above = p.z() - floor(p.x());
  if (above < 0.0) return true;
  if (std::abs(p.x()) > 9.02 || std::abs(p.y()) > 5.02) return true;
  return p.x() > 4.0 && p.x() < 5.0 && std::abs(p.y()) < 1.0 && above < 0.15;
}

PlacedScan look_round(const Eigen::Vector3d& sensor, Floor floor) {
  PlacedScan scan;
  scan.map_from_lidar.translation = sensor;
  for (int turn = 0; turn < 360; ++turn) {
    for (int tilt = -30; tilt <= 10; tilt += 2) {
      const double yaw = (turn + 0.3) * std::numbers::pi / 180.0;
      const double pitch = tilt * std::numbers::pi / 180.0;
      const Eigen::Vector3d direction(
          std::cos(pitch) * std::cos(yaw), std::cos(pitch) * std::sin(yaw), std::sin(pitch));
      double range = 0.3;
      while (range < 30.0 && !is_solid(sensor + range * direction, floor)) range += 0.002;
      if (range < 30.0) scan.points.push_back((range * direction).cast<float>());
    }
  }
  scan.origins.assign(scan.points.size(), Eigen::Vector3f::Zero());
  return scan;
}

GridMap map_place(Floor floor, const GridBand& band, int threads = 2) {
  ThreadPool pool(threads);
  BandMapper mapper(floor_map(floor), band, {});
  for (int i = -7; i <= 3; i += 2) {
    const double x = i;
    mapper.add(look_round({x, 0.3 * x, floor(x) + 1.0}, floor), Rigid3{}, pool);
  }
  return mapper.grid({});
}

int count(const GridMap& map, CellState state, const Eigen::AlignedBox2d& area) {
  int cells = 0;
  for (int y = 0; y < map.height; ++y) {
    for (int x = 0; x < map.width; ++x) {
      const Eigen::Vector2d middle =
          map.corner + Eigen::Vector2d(x + 0.5, y + 0.5) * map.resolution;
      if (area.contains(middle) && map.at(x, y).state == state) ++cells;
    }
  }
  return cells;
}

void expect_room(const GridMap& map) {
  const Eigen::AlignedBox2d inside(Eigen::Vector2d(-8.9, -4.9), Eigen::Vector2d(3.8, 4.9));
  EXPECT_EQ(count(map, CellState::occupied, inside), 0) << "no floor in the map";
  const double cells = inside.volume() / (map.resolution * map.resolution);
  EXPECT_GT(count(map, CellState::free, inside), 0.95 * cells);
  // The near wall, one cell in two or more of it hit by rays a degree apart.
  const Eigen::AlignedBox2d wall(Eigen::Vector2d(-6.0, 5.0), Eigen::Vector2d(3.0, 5.1));
  EXPECT_GT(count(map, CellState::occupied, wall), 45);
  EXPECT_EQ(count(map, CellState::free, {Eigen::Vector2d(-6.0, 5.1), Eigen::Vector2d(3.0, 9.0)}),
            0);
}

TEST(BandMapper, MapsARoom) {
  const GridMap map = map_place(level, {0.1, 1.8, 0.1, 50.0});
  expect_room(map);
  EXPECT_GT(
      count(map, CellState::occupied, {Eigen::Vector2d(3.95, -0.9), Eigen::Vector2d(4.2, 0.9)}), 8);
}

TEST(BandMapper, FollowsARamp) {
  expect_room(map_place(ramp, {0.1, 1.8, 0.1, 50.0}));
}

TEST(BandMapper, TheBandIsNotWidenedToWholeVoxels) {
  // The step is 0.15 m high; voxels of 0.1 m that start at zero would reach down to it.
  const Eigen::AlignedBox2d step(Eigen::Vector2d(3.9, -1.1), Eigen::Vector2d(5.1, 1.1));
  EXPECT_EQ(count(map_place(level, {0.16, 1.8, 0.1, 50.0}), CellState::occupied, step), 0);
  EXPECT_GT(count(map_place(level, {0.14, 1.8, 0.1, 50.0}), CellState::occupied, step), 5);
  EXPECT_EQ(count(map_place(ramp, {0.165, 1.8, 0.1, 50.0}), CellState::occupied, step), 0);
}

TEST(BandMapper, IsTheSameForAnyNumberOfThreads) {
  const GridBand band{0.1, 1.8, 0.1, 50.0};
  const GridMap one = map_place(ramp, band, 1);
  EXPECT_EQ(map_place(ramp, band, 3).cells, one.cells);
  EXPECT_EQ(map_place(ramp, band, 8).cells, one.cells);
}

/// Of the cell of a place; unknown beyond the map.
CellState state_at(const GridMap& map, double x, double y) {
  const Eigen::Vector2i cell = map.cell_of({x, y});
  return map.holds(cell.x(), cell.y()) ? map.at(cell.x(), cell.y()).state : CellState::unknown;
}

PlacedScan scan_of(const Eigen::Vector3d& sensor, const std::vector<Eigen::Vector3d>& places) {
  PlacedScan scan;
  scan.map_from_lidar.translation = sensor;
  for (const Eigen::Vector3d& place : places)
    scan.points.emplace_back((place - sensor).cast<float>());
  scan.origins.assign(scan.points.size(), Eigen::Vector3f::Zero());
  return scan;
}

// The floor is known up to x = 4 and goes on half a metre higher, which nobody can know.
TEST(BandMapper, AFloorThatWasOnlyGuessedIsNoObstacle) {
  std::vector<std::uint8_t> seen;
  for (int cell = 0; cell < 40 * 40; ++cell) seen.push_back(cell % 40 < 16 ? 1 : 0);
  const FloorMap floor({0.0, -5.0}, 0.25, 40, 40, std::vector<float>(1600, 0.0F), seen);
  EXPECT_TRUE(floor.is_seen(3.9, 0.0));
  EXPECT_FALSE(floor.is_seen(4.1, 0.0));
  EXPECT_FALSE(floor.is_seen(-0.1, 0.0));
  std::vector<Eigen::Vector3d> places;
  for (double y = -3.0; y < 3.0; y += 0.05) {
    places.emplace_back(5.03, y, 0.5 + 0.02 * y);  // floor, across
    places.emplace_back(2.03, y, 0.45);            // a bench where the floor is known
    for (const double z : {0.9, 1.7, 2.4}) places.emplace_back(7.03, y, z);  // a wall
  }
  const PlacedScan scan = scan_of({1.0, 0.0, 1.0}, places);
  UprightColumns upright;
  upright.add(scan, Rigid3{});
  ThreadPool pool(1);
  for (const UprightColumns* told :
       {static_cast<const UprightColumns*>(nullptr), &std::as_const(upright)}) {
    BandMapper mapper(floor, {0.1, 1.8, 0.1, 50.0}, {}, told);
    mapper.add(scan, Rigid3{}, pool);
    const GridMap map = mapper.grid({});
    const Eigen::AlignedBox2d guessed(Eigen::Vector2d(4.9, -2.9), Eigen::Vector2d(5.2, 2.9));
    const Eigen::AlignedBox2d bench(Eigen::Vector2d(1.9, -2.9), Eigen::Vector2d(2.2, 2.9));
    const Eigen::AlignedBox2d wall(Eigen::Vector2d(6.9, -2.9), Eigen::Vector2d(7.2, 2.9));
    EXPECT_EQ(count(map, CellState::occupied, guessed), told == nullptr ? 58 : 0);
    EXPECT_EQ(count(map, CellState::occupied, bench), 58);
    EXPECT_EQ(count(map, CellState::occupied, wall), 58);
  }
}

TEST(BandMapper, WhereTheCarrierWentNothingStandsBelowItsSensor) {
  const PlacedScan scan = scan_of({-2.0, 0.0, 1.0},
                                  {{1.05, 0.05, 0.5},    // on the way
                                   {2.05, 0.05, 1.5},    // a branch over the way
                                   {1.05, 0.65, 0.5},    // beside it
                                   {6.05, 0.05, 0.5}});  // beyond its end
  ThreadPool pool(1);
  for (const double half_width : {0.0, 0.3}) {
    BandMapper mapper(FloorMap(), {0.1, 1.8, 0.1, 50.0}, {});
    mapper.add(scan, Rigid3{}, pool);
    mapper.clear_way({{-2.0, 0.0, 1.0}, {0.0, 0.0, 1.0}, {2.5, 0.0, 1.0}}, half_width);
    mapper.clear_way({{20.0, 0.0, 1.0}}, half_width);
    const GridMap map = mapper.grid({});
    EXPECT_EQ(state_at(map, 1.05, 0.05), half_width > 0.0 ? CellState::free : CellState::occupied);
    EXPECT_EQ(state_at(map, 2.05, 0.05), CellState::occupied);
    EXPECT_EQ(state_at(map, 1.05, 0.65), CellState::occupied);
    EXPECT_EQ(state_at(map, 6.05, 0.05), CellState::occupied);
  }
}

TEST(BandMapper, BetweenPosesFarApartNobodyKnowsTheWay) {
  ThreadPool pool(1);
  BandMapper mapper(FloorMap(), {0.1, 1.8, 0.1, 50.0}, {});
  mapper.add(scan_of({-2.0, 0.0, 1.0}, {{1.05, 0.05, 0.5}}), Rigid3{}, pool);
  mapper.clear_way({{-2.0, 0.0, 1.0}, {4.0, 0.0, 1.0}}, 0.3);
  EXPECT_EQ(state_at(mapper.grid({}), 1.05, 0.05), CellState::occupied);
}

TEST(BandMapper, NothingSeenIsNoMap) {
  const BandMapper mapper(FloorMap(), {}, {});
  EXPECT_TRUE(mapper.grid({}).cells.empty());
}

TEST(BandMapper, ImpossibleBandsAreRefused) {
  EXPECT_THROW(BandMapper(FloorMap(), {1.0, 1.0, 0.05, 50.0}, {}), Error);
  EXPECT_THROW(BandMapper(FloorMap(), {std::nan(""), 1.0, 0.05, 50.0}, {}), Error);
  EXPECT_THROW(BandMapper(FloorMap(), {0.0, 1.0, 0.0, 50.0}, {}), Error);
  EXPECT_THROW(BandMapper(FloorMap(), {-50.0, 50.0, 0.05, 50.0}, {}), Error);
}

}  // namespace
}  // namespace kissmap
