// SPDX-License-Identifier: MIT
// Options of kissmap export-grid, each on a room in which what it does is known beforehand.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <set>

#include "cli/room_log.hpp"
#include "support/map_loader_rules.hpp"
#include "support/program.hpp"
#include "support/temp_dir.hpp"

namespace kissmap {
namespace {

namespace fs = std::filesystem;
using Eigen::Vector2d;

constexpr double resolution = 0.05;
constexpr double turn = 20.0 * std::numbers::pi / 180.0;

/// 8 x 6 m, walls of 2.4 m. A pen without a gate, 0.4 m high, a corner of it towards the sensor,
/// and a post of 10 cm; or neither.
RoomWalls room(bool furnished) {
  RoomWalls walls;
  add_box(walls, Vector2d::Zero(), {8.0, 6.0}, 2.4);
  if (furnished) {
    const Vector2d pen[] = {{1.4, 0.0}, {2.2, 0.8}, {3.0, 0.0}, {2.2, -0.8}};
    for (std::size_t i = 0; i < 4; ++i) walls.push_back({pen[i], pen[(i + 1) % 4], 0.4});
    add_box(walls, {-2.0, 1.5}, {0.1, 0.1}, 2.0);
  }
  return walls;
}

class GridOptions : public testing::Test {
 protected:
  fs::path path(const std::string& name) const { return folder_.path() / name; }

  void map_room(const RoomWalls& walls) const {
    write_room_log(path("log"), walls);
    run({"run", "--no-products", path("log"), "-o", path("session"), "--quiet"});
  }

  OccupancyPlan exported(std::vector<std::string> options) const {
    std::vector<std::string> all = {
        "export-grid", path("session"), "-o", path("map"), "--resolution", "0.05", "--overwrite"};
    all.insert(all.end(), options.begin(), options.end());
    run(all);
    return as_amcl_sees(load_map(path("map.yaml"), MapLoader::nav2));
  }

  static void run(std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), KISSMAP_BINARY);
    const ProgramResult result = run_program(arguments);
    ASSERT_EQ(result.exit_code, 0) << result.err;
  }

 private:
  TempDir folder_;
};

std::size_t count(const OccupancyPlan& plan,
                  PlanCell state,
                  const Vector2d& middle,
                  const Vector2d& size,
                  double angle) {
  std::size_t cells = 0;
  for (int y = 0; y < plan.height; ++y) {
    for (int x = 0; x < plan.width; ++x) {
      const Vector2d place = plan.origin + Vector2d(x + 0.5, y + 0.5) * plan.resolution;
      const Vector2d off = Eigen::Rotation2Dd(-angle) * place - middle;
      if ((off.cwiseAbs().array() > 0.5 * size.array()).any()) continue;
      cells += plan.cells[plan.index(x, y)] == state ? 1U : 0U;
    }
  }
  return cells;
}

double cells_of(const Vector2d& size) {
  return size.prod() / (resolution * resolution);
}

TEST_F(GridOptions, AlignAxesTurnsWallsAlongTheRows) {
  map_room(turned(room(false), turn));
  // The outer cells of walls, and two cells of margin on each side.
  const double beyond = 6.0 * resolution;
  const OccupancyPlan as_it_lies = exported({});
  const Vector2d box(8.0 * std::cos(turn) + 6.0 * std::sin(turn),
                     8.0 * std::sin(turn) + 6.0 * std::cos(turn));
  EXPECT_NEAR(as_it_lies.width * resolution, box.x() + 0.2, 0.15);
  EXPECT_NEAR(as_it_lies.height * resolution, box.y() + 0.2, 0.15);
  const OccupancyPlan aligned = exported({"--align-axes"});
  EXPECT_NEAR(aligned.width * resolution, 8.0 + 0.2, 0.15);
  EXPECT_NEAR(aligned.height * resolution, 6.0 + 0.2, 0.15);
  for (const double y : {-3.0, 3.0}) {
    const std::size_t wall = count(aligned, PlanCell::occupied, {0.0, y}, {7.8, beyond}, 0.0);
    EXPECT_GE(wall, 7.8 / resolution) << "a row of cells and no gap at y = " << y;
  }
  EXPECT_EQ(count(aligned, PlanCell::occupied, {0.0, 0.0}, {7.6, 5.6}, 0.0), 0U);
}

TEST_F(GridOptions, ConnectedKeepsTheFloorOfTheRoomButNotThatOfThePen) {
  map_room(turned(room(true), turn));
  const Vector2d pen(2.2, 0.0);
  const Vector2d inside(0.6, 0.6);
  const Vector2d corner(-3.0, -2.0);
  const OccupancyPlan all = exported({});
  EXPECT_GE(count(all, PlanCell::free, pen, inside, turn), 0.9 * cells_of(inside));
  const OccupancyPlan connected = exported({"--connected"});
  EXPECT_EQ(count(connected, PlanCell::free, pen, inside, turn), 0U);
  EXPECT_GE(count(connected, PlanCell::free, corner, inside, turn), 0.95 * cells_of(inside));
  EXPECT_EQ(std::ranges::count(all.cells, PlanCell::occupied),
            std::ranges::count(connected.cells, PlanCell::occupied));
}

TEST_F(GridOptions, MinGroupRemovesThePostButNotThePen) {
  map_room(turned(room(true), turn));
  const Vector2d post(-2.0, 1.5);
  const Vector2d around(0.3, 0.3);
  const std::size_t stands = count(exported({}), PlanCell::occupied, post, around, turn);
  EXPECT_GE(stands, 4U) << "its four sides";
  EXPECT_LE(stands, 25U);
  const OccupancyPlan without = exported({"--min-group", "30"});
  EXPECT_EQ(count(without, PlanCell::occupied, post, around, turn), 0U);
  // Each side of the pen is 1.13 m long and at 65 degrees to the rows: 20 cells or more.
  EXPECT_GE(count(without, PlanCell::occupied, {2.2, 0.0}, {1.8, 1.8}, turn), 80U);
  EXPECT_EQ(count(exported({"--min-group", "2"}), PlanCell::occupied, post, around, turn), stands);
}

TEST_F(GridOptions, MinSeenWantsThatMuchOfTheBand) {
  // Nothing is seen above the sensor, which is 0.9 of the 1.7 m of the band.
  RoomWalls low;
  add_box(low, Vector2d::Zero(), {8.0, 6.0}, room_sensor_height);
  map_room(turned(low, turn));
  const Vector2d before_wall(-3.5, 0.0);
  const Vector2d size(0.6, 3.0);
  EXPECT_GE(count(exported({"--min-seen", "0.4"}), PlanCell::free, before_wall, size, turn),
            0.9 * cells_of(size));
  const OccupancyPlan strict = exported({"--min-seen", "0.6"});
  EXPECT_EQ(std::ranges::count(strict.cells, PlanCell::free), 0);
  EXPECT_GE(std::ranges::count(strict.cells, PlanCell::occupied), 4 * 6.0 / resolution);
}

TEST_F(GridOptions, MinFreeWantsThatShareOfWhatWasSeen) {
  // Three scans make a belief of 0.93, below a threshold of 0.96 and above 0.5: neither occupied
  // nor free. Of the band over a wall of 0.6 m these are 0.5 of 1.7 m.
  RoomWalls walls = room(false);
  walls.push_back({{-2.0, -1.0}, {-2.0, 1.0}, 0.6});
  map_room(turned(walls, turn));
  const Vector2d wall(-2.0, 0.0);
  const Vector2d along(0.02, 1.8);
  const auto free_on_wall = [&](const char* share) {
    return count(
        exported({"--threshold", "0.96", "--min-free", share}), PlanCell::free, wall, along, turn);
  };
  EXPECT_GE(free_on_wall("0.6"), 10U);
  EXPECT_EQ(free_on_wall("0.8"), 0U);
}

}  // namespace
}  // namespace kissmap
