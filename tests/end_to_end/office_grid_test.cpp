// SPDX-License-Identifier: MIT
// 2D maps of a simulated office, by true poses, against its exact plan.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <deque>
#include <numbers>
#include <string>
#include <vector>

#include "end_to_end/grid_quality.hpp"
#include "kissmap/grid/band_mapper.hpp"
#include "simulator/scenario.hpp"
#include "simulator/tours.hpp"
#include "support/laser_robot.hpp"
#include "support/monte_carlo_localiser.hpp"

namespace kissmap {
namespace {

using simulator::ObjectClass;
using simulator::Simulator;

constexpr double floor_cell = 0.25;
constexpr std::size_t every = 4;            // scans
constexpr std::size_t every_crossing = 24;  // scans whose crossings are found exactly

/// Calls with each scan of the tour, placed by the truth.
template <typename Call>
void for_each_scan(const Simulator& simulator, const Call& call) {
  for (std::size_t i = 1; i < simulator.scan_count(); i += every) call(truly_placed(simulator, i));
}

/// The floor found from the scans, in the frame of the world.
FloorMap find_floor(const Simulator& simulator) {
  FloorSampler sampler(floor_cell, 25.0);
  SensorPath path;
  for_each_scan(simulator, [&](const PlacedScan& scan) {
    sampler.add(scan, Rigid3{});
    path.push_back(scan.map_from_lidar.translation);
  });
  const std::vector<FloorSample> samples = sampler.samples();
  const double height = sensor_height(path, samples, floor_cell);
  EXPECT_NEAR(height, 0.45, 0.03) << "the robot carries it there";
  return floor_under(path, samples, floor_cell, height);
}

std::vector<GridMap> map_bands(const Simulator& simulator, const std::vector<GridBand>& bands) {
  const FloorMap floor = find_floor(simulator);
  ThreadPool pool;
  std::deque<BandMapper> mappers;
  for (const GridBand& band : bands) mappers.emplace_back(floor, band);
  for_each_scan(simulator, [&](const PlacedScan& scan) {
    for (BandMapper& mapper : mappers) mapper.add(scan, Rigid3{}, pool);
  });
  std::vector<GridMap> maps;
  for (const BandMapper& mapper : mappers) maps.push_back(mapper.grid({}));
  return maps;
}

std::vector<GridQuality> qualities(const Simulator& simulator,
                                   const std::vector<GridBand>& bands,
                                   const std::vector<GridMap>& maps) {
  std::deque<GridJudge> judges;
  for (std::size_t k = 0; k < bands.size(); ++k) {
    judges.emplace_back(
        simulator, simulator::FloorBand{bands[k].z_min, bands[k].z_max, 0}, maps[k]);
  }
  for (std::size_t i = 1; i < simulator.scan_count(); i += every) {
    for (GridJudge& judge : judges) judge.observe(i, i % every_crossing == 1);
  }
  std::vector<GridQuality> found;
  for (const GridJudge& judge : judges) found.push_back(judge.judge(1));
  return found;
}

double recall_of(const GridQuality& quality, ObjectClass object_class) {
  return quality.class_recall[static_cast<std::size_t>(object_class)];
}

void expect_plan(const GridQuality& quality) {
  EXPECT_GE(quality.precision, 0.95);
  EXPECT_GE(quality.recall, 0.95);
  EXPECT_GE(quality.free_recall, 0.98);
  for (const ObjectClass c : {ObjectClass::wall,
                              ObjectClass::door,
                              ObjectClass::desk_leg,
                              ObjectClass::chair_leg,
                              ObjectClass::cabinet}) {
    EXPECT_GE(recall_of(quality, c), 0.9) << simulator::name(c);
  }
}

const GridBand navigation{0.1, 1.8, 0.05, 100.0};
const GridBand localization{0.1, 0.2, 0.05, 100.0};

OccupancyPlan plan_of(const GridMap& map) {
  OccupancyPlan plan;
  plan.width = map.width;
  plan.height = map.height;
  plan.resolution = map.resolution;
  plan.origin = map.corner;
  for (const GridCell& cell : map.cells) {
    plan.cells.push_back(cell.state == CellState::occupied ? PlanCell::occupied
                         : cell.state == CellState::free   ? PlanCell::free
                                                           : PlanCell::unknown);
  }
  return plan;
}

/// What a laser robot makes of a plan, from ten places.
struct Localised {
  int converged = 0;
  double rms = 0.0;  ///< m, over the last quarter of the drives that converged
};

class LaserRobotInTheOffice {
 public:
  OccupancyPlan exact_plan() const {
    const simulator::PlanFrame frame{{-1.0, -1.0}, 0.05, 840, 540};
    const Eigen::AlignedBox2d inside(
        Eigen::Vector2d::Zero(), Eigen::Vector2d(office_.options.length, office_.options.width));
    return kissmap::exact_plan(
        solids_in_band(office_.world, frame, {localization.z_min, localization.z_max, 0}),
        [&](const Eigen::Vector2d& place) { return inside.contains(place); });
  }

  Localised localise(const OccupancyPlan& plan) const {
    Localised result;
    double squares = 0.0;
    int steps = 0;
    for (std::uint64_t seed = 1; seed <= 10; ++seed) {
      const std::vector<double> errors = drive(plan, seed);
      if (errors.empty()) continue;
      ++result.converged;
      for (std::size_t i = 3 * errors.size() / 4; i < errors.size(); ++i) {
        squares += errors[i] * errors[i];
        ++steps;
      }
    }
    result.rms = std::sqrt(squares / std::max(1, steps));
    return result;
  }

 private:
  /// Errors [m] of a drive of 60 m; none if it ends 0.2 m or 10 degrees off.
  std::vector<double> drive(const OccupancyPlan& plan, std::uint64_t seed) const {
    LaserRobotOptions robot;
    robot.height = 0.15;
    robot.seed = seed;
    robot.start = 8.0 * static_cast<double>(seed);
    MonteCarloLocaliser localiser(plan, {}, seed);
    std::vector<double> errors;
    Pose2 before;
    double turned = 0.0;
    for (const LaserStep& step : drive_laser_robot(caster_, motion_, robot)) {
      localiser.update(before.inverse() * step.odometry_from_robot, step.ranges);
      before = step.odometry_from_robot;
      const Pose2 found = localiser.map_from_robot();
      const Pose2& truth = step.world_from_robot;
      errors.push_back(std::hypot(found.x - truth.x, found.y - truth.y));
      turned = std::abs(std::remainder(found.yaw - truth.yaw, 2.0 * std::numbers::pi));
    }
    const bool converged = errors.back() < 0.2 && turned < 10.0 * std::numbers::pi / 180.0;
    return converged ? errors : std::vector<double>{};
  }

  simulator::Office office_ = simulator::make_office(1);
  simulator::RayCaster caster_{office_.world};
  simulator::Motion motion_ = simulator::office_robot_tour(office_, 1);
};

// One test, because the maps take a while to make.
TEST(OfficeGrid, IsThePlanAndLocalisesARobotAsThePlanDoes) {
  const Simulator simulator =
      simulator::make_simulator({"office", "spinning32", "robot", 1, 0, 512, 1.0});
  const std::vector<GridMap> maps = map_bands(simulator, {navigation, localization});
  const std::vector<GridQuality> found = qualities(simulator, {navigation, localization}, maps);
  {
    SCOPED_TRACE("navigation");
    expect_plan(found[0]);
    EXPECT_GE(recall_of(found[0], ObjectClass::desk), 0.9);
  }
  {
    SCOPED_TRACE("localization");
    expect_plan(found[1]);
  }
  const LaserRobotInTheOffice robot;
  const Localised by_plan = robot.localise(robot.exact_plan());
  const Localised by_map = robot.localise(plan_of(maps[1]));
  ASSERT_GE(by_plan.converged, 9);
  EXPECT_GE(by_map.converged, by_plan.converged - 1);
  EXPECT_LE(by_map.rms, 1.2 * by_plan.rms);
}

}  // namespace
}  // namespace kissmap
