// SPDX-License-Identifier: MIT
// 2D maps of a simulated office, by true poses, against its exact plan.
#include <gtest/gtest.h>

#include <deque>
#include <vector>

#include "end_to_end/office_quality.hpp"
#include "end_to_end/office_robot.hpp"
#include "kissmap/grid/band_mapper.hpp"
#include "simulator/scenario.hpp"

namespace kissmap {
namespace {

using simulator::ObjectClass;
using simulator::Simulator;

constexpr double floor_cell = 0.25;
constexpr std::size_t every = 4;     // scans
constexpr double one_return = 0.71;  // probability, of what export-grid drops where it is alone

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
  for (const GridBand& band : bands) {
    const bool thin = band.z_max < 0.5;
    mappers.emplace_back(floor, band, thin ? localization_belief : BandBelief{});
  }
  for_each_scan(simulator, [&](const PlacedScan& scan) {
    for (BandMapper& mapper : mappers) mapper.add(scan, Rigid3{}, pool);
  });
  std::vector<GridMap> maps;
  for (std::size_t k = 0; k < bands.size(); ++k) {
    const bool thin = bands[k].z_max < 0.5;
    maps.push_back(
        mappers[k].grid({thin ? localization_threshold : navigation_threshold, 0.5, 0.0}));
    if (!thin) remove_small_groups(2, maps.back(), one_return);
  }
  return maps;
}

const GridBand navigation{0.1, 1.8, 0.05, 100.0};
const GridBand localization{0.1, 0.2, 0.05, 100.0};

// One test, because the maps take a while to make.
TEST(OfficeGrid, IsThePlanAndLocalisesARobotAsThePlanDoes) {
  const Simulator simulator =
      simulator::make_simulator({"office", "spinning32", "robot", 1, 0, 512, 1.0});
  const std::vector<GridMap> maps = map_bands(simulator, {navigation, localization});
  const std::vector<GridQuality> found =
      judge_office(simulator, {navigation, localization}, maps, 1);
  {
    SCOPED_TRACE("navigation");
    expect_office_plan(found[0]);
    EXPECT_GE(found[0].recall_of(ObjectClass::desk), 0.9);
    EXPECT_LE(found[0].widest_wall_gap, 2);
  }
  {
    SCOPED_TRACE("localization");
    expect_office_plan(found[1]);
    EXPECT_LE(found[1].widest_wall_gap, 2);
  }
  const LaserRobotInTheOffice robot;
  expect_doors_as_they_are(robot.office(), maps[0]);
  const Localised by_plan =
      robot.localise(robot.exact_plan(localization.z_min, localization.z_max));
  const Localised by_map = robot.localise(plan_of(maps[1]));
  ASSERT_GE(by_plan.converged, 9);
  EXPECT_GE(by_map.converged, by_plan.converged - 1);
  EXPECT_LE(by_map.rms, 1.2 * by_plan.rms);
}

}  // namespace
}  // namespace kissmap
