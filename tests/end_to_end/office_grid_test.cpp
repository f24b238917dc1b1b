// SPDX-License-Identifier: MIT
// 2D maps of a simulated office, by true poses, against its exact plan.
#include <gtest/gtest.h>

#include <deque>
#include <vector>

#include "end_to_end/grid_quality.hpp"
#include "kissmap/grid/band_mapper.hpp"
#include "simulator/scenario.hpp"

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

std::vector<GridQuality> qualities(const Simulator& simulator, const std::vector<GridBand>& bands) {
  const FloorMap floor = find_floor(simulator);
  ThreadPool pool;
  std::deque<BandMapper> mappers;
  for (const GridBand& band : bands) mappers.emplace_back(floor, band, OccupancyOptions{});
  for_each_scan(simulator, [&](const PlacedScan& scan) {
    for (BandMapper& mapper : mappers) mapper.add(scan, Rigid3{}, pool);
  });
  std::vector<GridMap> maps;
  for (const BandMapper& mapper : mappers) maps.push_back(mapper.grid({}));
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

TEST(OfficeGrid, IsThePlanForNavigationAndForLocalization) {
  const Simulator simulator =
      simulator::make_simulator({"office", "spinning32", "robot", 1, 0, 512, 1.0});
  const std::vector<GridQuality> found =
      qualities(simulator, {{0.1, 1.8, 0.05, 100.0}, {0.1, 0.2, 0.05, 100.0}});
  {
    SCOPED_TRACE("navigation");
    expect_plan(found[0]);
    EXPECT_GE(recall_of(found[0], ObjectClass::desk), 0.9);
  }
  SCOPED_TRACE("localization");
  expect_plan(found[1]);
  for (const GridQuality& quality : found) {
    RecordProperty("precision", std::to_string(quality.precision));
    RecordProperty("recall", std::to_string(quality.recall));
    RecordProperty("free_recall", std::to_string(quality.free_recall));
  }
}

}  // namespace
}  // namespace kissmap
