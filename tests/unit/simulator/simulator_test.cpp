// SPDX-License-Identifier: MIT
#include "simulator/simulator.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "kissmap/error.hpp"
#include "kissmap/parallel/thread_pool.hpp"
#include "simulator/scenario.hpp"
#include "simulator/town.hpp"

namespace kissmap::simulator {
namespace {

using Eigen::Vector3d;

Scenario scenario(const char* world, const char* sensor, const char* motion, int columns) {
  return {world, sensor, motion, 3, 0, columns, 1.0};
}

bool same(const Scan& a, const Scan& b) {
  return a.stamp_ns == b.stamp_ns && a.points == b.points && a.time_offsets == b.time_offsets &&
         a.intensities == b.intensities && a.no_return_directions == b.no_return_directions &&
         a.no_return_time_offsets == b.no_return_time_offsets;
}

std::int64_t time_of(const Scan& scan, std::size_t i) {
  return scan.stamp_ns + std::llround(1e9 * static_cast<double>(scan.time_offsets[i]));
}

// Inside a closed box, every beam returns, at a range that can be computed by hand.
Simulator in_a_box(double noise, double dropout) {
  World world;
  for (int axis = 0; axis < 3; ++axis) {
    for (const double side : {-1.0, 1.0}) {
      const Vector3d middle = side * 10.5 * Vector3d::Unit(axis);
      const Vector3d half = Vector3d::Constant(11.0) - 10.5 * Vector3d::Unit(axis);
      world.primitives.push_back(
          make_box(ObjectClass::wall, Rigid3{}, middle - half, middle + half));
    }
  }
  SensorModel sensor = spinning_sensor(16, 500);
  sensor.range_noise = noise;
  sensor.dropout = dropout;
  Motion still;
  still.control = {PoseVector::Zero()};
  return {std::move(world), std::move(sensor), std::move(still), 9, 20};
}

TEST(Simulator, FillsScansConsistently) {
  for (const char* sensor : {"spinning32", "rosette", "raster"}) {
    const Simulator simulator =
        make_simulator(scenario("town", sensor, "car", std::string(sensor) == "rosette" ? 0 : 100));
    const LabelledScan labelled = simulator.labelled_scan(7);
    const Scan& scan = labelled.scan;
    require_consistent(scan);
    EXPECT_EQ(scan.stamp_ns, Simulator::first_stamp_ns + 700'000'000);
    EXPECT_EQ(scan.stamp_instant, StampInstant::sweep_start);
    EXPECT_EQ(scan.compensation, Compensation::no);
    EXPECT_EQ(scan.time_source, TimeSource::recorded);
    EXPECT_EQ(labelled.classes.size(), scan.points.size());
    EXPECT_EQ(scan.intensities.size(), scan.points.size());
    EXPECT_EQ(scan.no_return_time_offsets.size(), scan.no_return_directions.size());
    EXPECT_GT(scan.no_return_directions.size(), 100U) << "the sky";
    const std::size_t beams = scan.points.size() + scan.no_return_directions.size();
    EXPECT_LT(beams, simulator.sensor().pattern.size());
    EXPECT_GT(static_cast<double>(beams),
              0.96 * static_cast<double>(simulator.sensor().pattern.size()));
    for (const Eigen::Vector3f& d : scan.no_return_directions) EXPECT_NEAR(d.norm(), 1.0F, 1e-6F);
    const auto span = time_span(scan);
    ASSERT_TRUE(span);
    EXPECT_GE(span->first, 0.0F);
    EXPECT_LT(span->last, 0.1F);
  }
}

TEST(Simulator, GivesTheSameScansInAnyOrderAndFromAnyThread) {
  const Simulator simulator = make_simulator(scenario("town", "spinning16", "handheld", 90));
  std::vector<Scan> forwards(12);
  std::vector<Scan> at_once(12);
  for (std::size_t i = 0; i < 12; ++i) forwards[i] = simulator.scan(i);
  for (std::size_t i = 12; i-- > 0;) EXPECT_TRUE(same(simulator.scan(i), forwards[i]));
  ThreadPool(4).for_each_chunk(12, [&](std::size_t i) { at_once[i] = simulator.scan(i); });
  for (std::size_t i = 0; i < 12; ++i) EXPECT_TRUE(same(at_once[i], forwards[i]));
  const Simulator again = make_simulator(scenario("town", "spinning16", "handheld", 90));
  EXPECT_TRUE(same(again.scan(5), forwards[5]));
}

TEST(Simulator, OtherSeedsGiveOtherNoise) {
  World world;
  world.primitives.push_back(make_box(ObjectClass::wall, Rigid3{}, {5, -50, -50}, {6, 50, 50}));
  Motion still;
  still.control = {PoseVector::Zero()};
  const Simulator a(world, raster_sensor(20), still, 1, 2);
  const Simulator b(world, raster_sensor(20), still, 2, 2);
  EXPECT_FALSE(same(a.scan(0), b.scan(0)));
  EXPECT_NE(a.scan(0).points, a.scan(1).points) << "noise differs from sweep to sweep";
}

class EveryPlace : public testing::TestWithParam<Scenario> {};

TEST_P(EveryPlace, NoiseFreePointsLieOnSurfacesOfTheirClassAtTheirTime) {
  Simulator base = make_simulator(GetParam());
  SensorModel sensor = base.sensor();
  sensor.range_noise = sensor.dropout = 0.0;
  const Simulator simulator(base.caster().world(), sensor, base.motion(), 1);
  int moving = 0;
  for (std::size_t i = 3; i < simulator.scan_count(); i += simulator.scan_count() / 12) {
    const LabelledScan labelled = simulator.labelled_scan(i);
    for (std::size_t k = i % 17; k < labelled.scan.points.size(); k += 41) {
      const std::int64_t stamp = time_of(labelled.scan, k);
      const Vector3d in_map =
          simulator.map_from_lidar(stamp) * labelled.scan.points[k].cast<double>().eval();
      const double time = 1e-9 * static_cast<double>(stamp - Simulator::first_stamp_ns);
      ASSERT_NEAR(simulator.caster().distance(in_map, time), 0.0, 2e-5);
      moving += is_moving(labelled.classes[k]) ? 1 : 0;
    }
  }
  const bool lively = !simulator.caster().world().moving.empty();
  EXPECT_EQ(moving > 0, lively) << "moving objects are seen where there are any";
}

INSTANTIATE_TEST_SUITE_P(Places,
                         EveryPlace,
                         testing::Values(scenario("town", "spinning64", "car", 128),
                                         scenario("town", "rosette", "handheld", 0),
                                         scenario("garage", "spinning32", "car", 100),
                                         scenario("hill", "spinning32", "car", 100),
                                         scenario("office", "spinning16", "robot", 300),
                                         scenario("office", "raster", "handheld", 100)),
                         [](const auto& tested) {
                           return tested.param.world + "_" + tested.param.sensor;
                         });

TEST(Simulator, NoiseAndDropoutsHaveTheStatedStatistics) {
  const Simulator exact = in_a_box(0.0, 0.0);
  const Simulator noisy = in_a_box(0.02, 0.0);
  double sum = 0.0;
  double squares = 0.0;
  double n = 0.0;
  for (std::size_t i = 0; i < 20; ++i) {
    const Scan truth = exact.scan(i);
    const Scan scan = noisy.scan(i);
    ASSERT_EQ(truth.points.size(), 8000U);
    ASSERT_EQ(scan.points.size(), 8000U);
    for (std::size_t k = 0; k < scan.points.size(); ++k) {
      const double error = scan.points[k].norm() - truth.points[k].norm();
      sum += error;
      squares += error * error;
      n += 1.0;
      EXPECT_LT(scan.points[k].normalized().cross(truth.points[k].normalized()).norm(), 1e-6F);
    }
  }
  // Four standard errors of mean and deviation of n normal numbers.
  EXPECT_NEAR(sum / n, 0.0, 4 * 0.02 / std::sqrt(n));
  EXPECT_NEAR(std::sqrt(squares / n), 0.02, 4 * 0.02 / std::sqrt(2 * n));
}

TEST(Simulator, DropoutsVanishWithoutATrace) {
  const Simulator simulator = in_a_box(0.02, 0.02);
  double missing = 0.0;
  for (std::size_t i = 0; i < 20; ++i) {
    const Scan scan = simulator.scan(i);
    EXPECT_TRUE(scan.no_return_directions.empty());
    missing += static_cast<double>(8000 - scan.points.size());
  }
  const double n = 20.0 * 8000.0;
  EXPECT_NEAR(missing / n, 0.02, 4 * std::sqrt(0.02 * 0.98 / n));
}

TEST(Simulator, RangesAndIntensitiesAreThoseOfTheBox) {
  const Scan scan = in_a_box(0.0, 0.0).scan(0);
  for (std::size_t i = 0; i < scan.points.size(); ++i) {
    EXPECT_NEAR(scan.points[i].cwiseAbs().maxCoeff(), 10.0F, 1e-5F);
    EXPECT_NEAR(scan.intensities[i], 255.0F * 0.7F * 10.0F / scan.points[i].norm(), 1e-2F);
  }
}

TEST(Simulator, MotionDuringTheSweepIsInThePoints) {
  const Simulator simulator = make_simulator(scenario("town", "spinning16", "car", 300));
  const Scan scan = simulator.scan(200);
  const Rigid3 start = simulator.map_from_lidar(scan.stamp_ns);
  const Rigid3 end = simulator.map_from_lidar(simulator.stamp_ns(201));
  EXPECT_GT((end.translation - start.translation).norm(), 0.2) << "the car should be driving here";
}

TEST(Scenario, RefusesUnknownWordsAndCarsInOffices) {
  EXPECT_THROW(make_simulator(scenario("village", "spinning16", "car", 0)), Error);
  EXPECT_THROW(make_simulator(scenario("town", "spinning17", "car", 0)), Error);
  EXPECT_THROW(make_simulator(scenario("town", "spinning16", "boat", 0)), Error);
  EXPECT_THROW(make_simulator(scenario("office", "spinning16", "car", 0)), Error);
  Scenario frantic;
  frantic.liveliness = 1.5;
  EXPECT_THROW(make_simulator(frantic), Error);
}

}  // namespace
}  // namespace kissmap::simulator
