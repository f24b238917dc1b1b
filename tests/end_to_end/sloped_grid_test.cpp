// SPDX-License-Identifier: MIT
// 2D maps of a garage with ramps and of a hilly street, by true poses, against their exact plans.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include "end_to_end/grid_quality.hpp"
#include "kissmap/grid/band_mapper.hpp"
#include "kissmap/grid/levels.hpp"
#include "simulator/scenario.hpp"

namespace kissmap {
namespace {

using simulator::ObjectClass;
using simulator::Simulator;

constexpr double floor_cell = 0.25;
constexpr std::size_t every = 3;            // scans
constexpr std::size_t every_crossing = 36;  // scans whose crossings are found exactly
const GridBand band{0.1, 1.8, 0.1, 100.0};

class SlopedGrid : public testing::Test {
 protected:
  void drive(const char* world) {
    simulator::Scenario scenario;
    scenario.world = world;
    scenario.sensor = "spinning32";
    scenario.columns = 400;
    simulator_.reset(new Simulator(simulator::make_simulator(scenario)));
    FloorSampler sampler(floor_cell, 25.0);
    for (std::size_t i = 1; i < simulator_->scan_count(); i += every) {
      const PlacedScan scan = truly_placed(*simulator_, i);
      sampler.add(scan, Rigid3{});
      path_.push_back(scan.map_from_lidar.translation);
    }
    samples_ = sampler.samples();
    levels_ = levels_of(path_);
  }

  GridQuality quality(std::uint32_t level) {
    SensorPath path;
    for (std::size_t i = 0; i < path_.size(); ++i) {
      if (levels_[i] == level) path.push_back(path_[i]);
    }
    const double height = sensor_height(path_, samples_, floor_cell);
    ThreadPool pool;
    BandMapper mapper(floor_under(path, samples_, floor_cell, height), band);
    for (std::size_t i = 0; i < path_.size(); ++i) {
      if (levels_[i] == level) mapper.add(truly_placed(*simulator_, 1 + every * i), Rigid3{}, pool);
    }
    const GridMap map = mapper.grid({});
    GridJudge judge(*simulator_, {band.z_min, band.z_max, static_cast<int>(level)}, map);
    for (std::size_t i = 0; i < path_.size(); ++i) {
      const std::size_t scan = 1 + every * i;
      if (levels_[i] == level) judge.observe(scan, scan % every_crossing == 1);
    }
    return judge.judge(1);
  }

  std::uint32_t level_count() const { return *std::ranges::max_element(levels_) + 1; }

 private:
  std::unique_ptr<Simulator> simulator_;
  SensorPath path_;
  std::vector<FloorSample> samples_;
  std::vector<std::uint32_t> levels_;
};

void expect_plan(const GridQuality& quality) {
  EXPECT_GE(quality.precision, 0.95) << "no floor in the map";
  EXPECT_GE(quality.free_recall, 0.95);
  // Roofs and bonnets of cars, seen at a grazing angle and through each other, are found worse.
  for (const ObjectClass c :
       {ObjectClass::wall, ObjectClass::pillar, ObjectClass::building, ObjectClass::pole}) {
    const double recall = quality.recall_of(c);
    if (!std::isnan(recall)) {
      EXPECT_GE(recall, 0.95) << simulator::name(c);
    }
  }
}

TEST_F(SlopedGrid, OfAGarageIsThePlanOfEachStorey) {
  drive("garage");
  ASSERT_EQ(level_count(), 2U);
  for (const std::uint32_t level : {0U, 1U}) {
    SCOPED_TRACE("level " + std::to_string(level));
    expect_plan(quality(level));
  }
}

TEST_F(SlopedGrid, OfAHillyStreetIsItsPlan) {
  drive("hill");
  ASSERT_EQ(level_count(), 1U);
  expect_plan(quality(0));
}

}  // namespace
}  // namespace kissmap
