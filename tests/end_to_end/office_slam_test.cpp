// SPDX-License-Identifier: MIT
// From a recorded log to a map a robot finds itself on, with nothing but the program: a simulated
// office, `kissmap run`, `kissmap export-grid`, read back as map servers do.
#include <gtest/gtest.h>

#include <filesystem>
#include <string>

#include "end_to_end/map_in_world.hpp"
#include "end_to_end/office_quality.hpp"
#include "end_to_end/office_robot.hpp"
#include "simulator/log_folder.hpp"
#include "simulator/scenario.hpp"
#include "support/map_loader_rules.hpp"
#include "support/program.hpp"
#include "support/temp_dir.hpp"
#ifdef KISSMAP_HAS_MRPT
#include "clients/mrpt_client.hpp"
#endif

namespace kissmap {
namespace {

namespace fs = std::filesystem;
using simulator::Simulator;

const GridBand navigation{0.1, 1.8, 0.05, 100.0};
const GridBand localization{0.1, 0.2, 0.05, 100.0};
constexpr int reach = 2;  // cells
const Eigen::AlignedBox2d storey(Eigen::Vector2d(-2.0, -2.0), Eigen::Vector2d(42.0, 27.0));

/// As a program writes it that takes the first row for the lowest, of an image with a margin of a
/// metre along one side: corridors and outer walls of an office are the same when mirrored about
/// the middle, and a robot that keeps to them is none the wiser.
OccupancyPlan upside_down(const OccupancyPlan& plan) {
  OccupancyPlan turned = plan;
  turned.origin.y() += 1.0;
  for (int row = 0; row < plan.height; ++row) {
    for (int column = 0; column < plan.width; ++column) {
      turned.cells[turned.index(column, row)] =
          plan.cells[plan.index(column, plan.height - 1 - row)];
    }
  }
  return turned;
}

OccupancyPlan a_metre_aside(OccupancyPlan plan) {
  plan.origin.x() += 1.0;
  return plan;
}

class OfficeBySlam : public testing::Test {
 protected:
  void SetUp() override {
    write_log_folder(simulator_, path("log"), 2, [](std::size_t) {});
    run({"run", path("log") / "scans", "-o", path("session"), "--quiet"});
    run({"export-grid", path("session"), "-o", path("laser"), "--for", "localization", "--quiet"});
    if (HasFatalFailure()) return;
    world_from_map_ = world_from_level(path("session"), simulator_);
  }

  fs::path path(const std::string& name) const { return folder_.path() / name; }
  fs::path navigation_map() const { return path("session") / "products" / "grid.yaml"; }
  fs::path laser_map() const { return path("laser.yaml"); }
  static OccupancyPlan loaded(const fs::path& yaml) {
    return as_amcl_sees(load_map(yaml, MapLoader::nav2));
  }
  static void run(std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), KISSMAP_BINARY);
    const ProgramResult result = run_program(arguments);
    ASSERT_EQ(result.exit_code, 0) << result.err;
  }

  void expect_plan_within_two_cells() const {
    const std::vector<GridMap> maps = {
        map_in_world(loaded(navigation_map()), world_from_map_, storey),
        map_in_world(loaded(laser_map()), world_from_map_, storey)};
    EXPECT_EQ(maps[0].resolution, 0.05) << "indoors by itself";
    const std::vector<GridQuality> found =
        judge_office(simulator_, {navigation, localization}, maps, reach);
    EXPECT_GE(found[0].recall_of(simulator::ObjectClass::desk), 0.9);
    for (const std::size_t i : {0U, 1U}) {
      SCOPED_TRACE(i == 0 ? "navigation" : "localization");
      expect_office_plan(found[i]);
      EXPECT_LE(found[i].widest_wall_gap, 2);
      expect_doors_as_they_are(robot_.office(), maps[i]);
    }
  }

  void expect_robot_finds_itself() const {
    const Localised by_plan =
        robot_.localise(robot_.exact_plan(localization.z_min, localization.z_max));
    const Localised by_map = robot_.localise(loaded(laser_map()), world_from_map_);
    ASSERT_GE(by_plan.converged, 9);
    EXPECT_GE(by_map.converged, by_plan.converged - 1);
    EXPECT_LE(by_map.rms, 1.2 * by_plan.rms);
    // The judge would notice a map that lies wrong.
    const OccupancyPlan map = loaded(laser_map());
    EXPECT_EQ(robot_.localise(upside_down(map), world_from_map_, 3).converged, 0);
    EXPECT_EQ(robot_.localise(a_metre_aside(map), world_from_map_, 3).converged, 0);
    RecordProperty("plan_rms_mm", static_cast<int>(1000.0 * by_plan.rms));
    RecordProperty("map_rms_mm", static_cast<int>(1000.0 * by_map.rms));
  }

#ifdef KISSMAP_HAS_MRPT
  void expect_mrpt_finds_itself() const {
    LaserRobotOptions options;
    options.height = 0.15;
    std::vector<LaserStep> steps = robot_.drive(options);
    for (LaserStep& step : steps) {  // MRPT is told the truth in the frame of the map
      step.world_from_robot = world_from_map_.inverse() * step.world_from_robot;
    }
    const Pose2& begin = steps.front().world_from_robot;
    const Eigen::Vector2d place(begin.x, begin.y);
    const Eigen::AlignedBox2d start(place - Eigen::Vector2d(0.8, 1.2),
                                    place + Eigen::Vector2d(1.2, 0.8));
    EXPECT_LT(median_error_with_mrpt(laser_map(), steps, options, start, path(""), {0.0, 0.1}),
              0.1);
  }
#endif

 private:
  TempDir folder_;
  Simulator simulator_ =
      simulator::make_simulator({"office", "spinning32", "robot", 1, 0, 512, 1.0});
  LaserRobotInTheOffice robot_;
  Pose2 world_from_map_;
};

// One test, because the maps take a while to make.
TEST_F(OfficeBySlam, IsThePlanAndLocalisesRobotsAsThePlanDoes) {
  expect_plan_within_two_cells();
  expect_robot_finds_itself();
#ifdef KISSMAP_HAS_MRPT
  expect_mrpt_finds_itself();
#endif
}

}  // namespace
}  // namespace kissmap
