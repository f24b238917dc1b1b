// SPDX-License-Identifier: MIT
// From a recorded log of a hilly street and of a garage to their 2D maps, with nothing but the
// program: `kissmap run`, `kissmap export-grid`, against the exact plans.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <memory>

#include "end_to_end/grid_quality.hpp"
#include "end_to_end/map_in_world.hpp"
#include "simulator/log_folder.hpp"
#include "simulator/scenario.hpp"
#include "support/map_loader_rules.hpp"
#include "support/program.hpp"
#include "support/temp_dir.hpp"

namespace kissmap {
namespace {

namespace fs = std::filesystem;
using simulator::ObjectClass;
using simulator::Simulator;
using testing::HasSubstr;

constexpr std::size_t every = 2;        // scans
constexpr std::size_t every_seen = 30;  // scans of which the judge looks at one

class SlopedBySlam : public testing::Test {
 protected:
  void drive(const char* world, int columns) {
    simulator::Scenario scenario;
    scenario.world = world;
    scenario.sensor = "spinning32";
    scenario.columns = columns;
    simulator_.reset(new Simulator(simulator::make_simulator(scenario)));
    write_log_folder(
        *simulator_, path("log"), 2, [](std::size_t) {}, false, every);
    run({"run", path("log") / "scans", "-o", path("session"), "--no-products", "--quiet"});
  }

  void export_grid(const std::vector<std::string>& more = {}) const {
    std::vector<std::string> arguments = {
        "export-grid", path("session"), "-o", path("map"), "--resolution", "0.1", "--quiet"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    run(arguments);
  }

  fs::path path(const std::string& name) const { return folder_.path() / name; }

  GridMap loaded(const std::string& name, const Eigen::AlignedBox2d& area) const {
    return map_in_world(as_amcl_sees(load_map(path(name), MapLoader::nav2)),
                        world_from_level(path("session"), *simulator_),
                        area);
  }

  /// Height of the sensor in the world at a scan.
  double height_at(std::size_t scan) const { return place_at(scan).z(); }
  Eigen::Vector3d place_at(std::size_t scan) const {
    return simulator_->map_from_lidar(simulator_->stamp_ns(scan)).translation;
  }

  /// By scans whose sensor is between two heights [m]; `reach` [cells] as in GridJudge.
  GridQuality judge(const GridMap& map, int level, double low, double high, int reach) const {
    GridJudge judge(*simulator_, {0.1, 1.8, level}, map);
    for (std::size_t i = 1; i < simulator_->scan_count(); i += every_seen) {
      if (height_at(i) >= low && height_at(i) <= high) judge.observe(i, i % (8 * every_seen) == 1);
    }
    return judge.judge(reach);
  }

  /// Occupied cells within 0.8 m of where the sensor was.
  int occupied_on_way(const GridMap& map) const {
    int cells = 0;
    for (int y = 0; y < map.height; ++y) {
      for (int x = 0; x < map.width; ++x) {
        if (map.at(x, y).state != CellState::occupied) continue;
        const Eigen::Vector2d place =
            map.corner + Eigen::Vector2d(x + 0.5, y + 0.5) * map.resolution;
        bool on_way = false;
        for (std::size_t i = 0; i < simulator_->scan_count() && !on_way; ++i) {
          on_way = (place_at(i).head<2>() - place).norm() < 0.8;
        }
        cells += on_way ? 1 : 0;
      }
    }
    return cells;
  }

  const Simulator& simulator() const { return *simulator_; }

  static void run(std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), KISSMAP_BINARY);
    const ProgramResult result = run_program(arguments);
    ASSERT_EQ(result.exit_code, 0) << result.err;
  }

 private:
  TempDir folder_;
  std::unique_ptr<Simulator> simulator_;
};

void expect_plan(const GridQuality& quality) {
  EXPECT_GE(quality.precision, 0.95) << "no floor in the map";
  EXPECT_GE(quality.free_recall, 0.95);
  for (const ObjectClass c :
       {ObjectClass::wall, ObjectClass::pillar, ObjectClass::building, ObjectClass::pole}) {
    const double recall = quality.recall_of(c);
    if (!std::isnan(recall)) {
      EXPECT_GE(recall, 0.9) << simulator::name(c);
    }
  }
}

TEST_F(SlopedBySlam, AHillyStreetIsItsPlan) {
  drive("hill", 512);
  export_grid();
  const GridMap map =
      loaded("map.yaml", {Eigen::Vector2d(-80.0, -60.0), Eigen::Vector2d(200.0, 140.0)});
  // The ground of the first local map is taken for level. Here it lies on the slope, so that the
  // plan is seen some degrees askew, and is up to half a metre off in the plane.
  expect_plan(judge(map, 0, -100.0, 100.0, 5));
  EXPECT_EQ(occupied_on_way(map), 0);
}

/// Of all that an export of several levels writes only the list is there already.
void expect_list_is_kept(const fs::path& session, const fs::path& folder) {
  fs::create_directory(folder);
  std::ofstream(folder / "map_levels.yaml") << "mine";
  const ProgramResult refused =
      run_program({KISSMAP_BINARY, "export-grid", session, "-o", folder / "map"});
  EXPECT_EQ(refused.exit_code, 4);
  EXPECT_THAT(refused.err, HasSubstr("map_levels.yaml"));
  EXPECT_EQ(file_text(folder / "map_levels.yaml"), "mine");
}

TEST_F(SlopedBySlam, AGarageIsTwoPlansAndTheirList) {
  drive("garage", 1024);
  export_grid();
  EXPECT_FALSE(fs::exists(path("map.yaml")));
  const std::string list = file_text(path("map_levels.yaml"));
  EXPECT_THAT(list, HasSubstr("map: \"map_level0.yaml\""));
  EXPECT_THAT(list, HasSubstr("map: \"map_level1.yaml\""));
  EXPECT_EQ(list.find("level2"), std::string::npos);
  expect_list_is_kept(path("session"), path("kept"));
  const Eigen::AlignedBox2d area(Eigen::Vector2d(-2.0, -2.0), Eigen::Vector2d(62.0, 36.0));
  const double carried = height_at(0);  // above level 0, which is flat there
  {
    SCOPED_TRACE("level 0");
    expect_plan(judge(loaded("map_level0.yaml", area), 0, carried - 0.1, carried + 0.4, 2));
  }
  {
    SCOPED_TRACE("level 1");
    expect_plan(judge(loaded("map_level1.yaml", area), 1, carried + 2.8, carried + 3.3, 2));
  }
}

}  // namespace
}  // namespace kissmap
