// SPDX-License-Identifier: MIT
#include "simulator/sensor.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <set>

#include "kissmap/error.hpp"

namespace kissmap::simulator {
namespace {

constexpr double degree = std::numbers::pi / 180.0;

double elevation(const Beam& shot) {
  return std::asin(shot.direction.z());
}
double azimuth(const Beam& shot) {
  return std::atan2(shot.direction.y(), shot.direction.x());
}

class AnySensor : public testing::TestWithParam<const char*> {};

TEST_P(AnySensor, FiresUnitDirectionsInOrderWithinTheSweep) {
  const SensorModel sensor = sensor_by_name(GetParam());
  double last = 0.0;
  for (std::size_t i = 0; i < sensor.pattern.size(); ++i) {
    const Beam shot = beam(sensor, 5, i);
    EXPECT_NEAR(shot.direction.norm(), 1.0, 1e-12);
    EXPECT_GE(shot.time_offset, last);
    last = shot.time_offset;
  }
  EXPECT_LT(last, sensor.period);
  EXPECT_GT(last, 0.99 * sensor.period);
}

INSTANTIATE_TEST_SUITE_P(
    Sensors,
    AnySensor,
    testing::Values("spinning16", "spinning32", "spinning64", "rosette", "raster"));

struct Rings {
  int rings;
  std::size_t shots;
  double low_deg;
  double high_deg;
};

class Spinning : public testing::TestWithParam<Rings> {};

TEST_P(Spinning, CoversItsFieldWithItsRings) {
  const Rings expected = GetParam();
  const SensorModel sensor = spinning_sensor(expected.rings);
  ASSERT_EQ(sensor.pattern.size(), expected.shots);
  std::set<std::int64_t> elevations;
  std::set<std::int64_t> azimuths;
  for (const Beam& shot : sensor.pattern) {
    elevations.insert(std::llround(elevation(shot) * 1e9));
    azimuths.insert(std::llround(azimuth(shot) * 1e9));
  }
  EXPECT_EQ(elevations.size(), static_cast<std::size_t>(expected.rings));
  EXPECT_NEAR(1e-9 * static_cast<double>(*elevations.begin()), expected.low_deg * degree, 1e-8);
  EXPECT_NEAR(1e-9 * static_cast<double>(*elevations.rbegin()), expected.high_deg * degree, 1e-8);
  EXPECT_EQ(azimuths.size(), expected.shots / static_cast<std::size_t>(expected.rings));
}

INSTANTIATE_TEST_SUITE_P(Rings,
                         Spinning,
                         testing::Values(Rings{16, 14'400, -15.0, 15.0},
                                         Rings{32, 32'768, -30.0, 10.0},
                                         Rings{64, 65'536, -22.5, 22.5}));

TEST(Spinning, TurnsClockwiseFromTheRear) {
  const SensorModel sensor = spinning_sensor(16, 360);
  EXPECT_GT(azimuth(sensor.pattern.front()), 179.0 * degree);
  EXPECT_NEAR(azimuth(sensor.pattern[16 * 90]), 89.5 * degree, 1e-9) << "left after a quarter";
  EXPECT_NEAR(sensor.pattern[16 * 90].time_offset, 0.025 + 0.1 * 0.5 / 360, 1e-12);
}

TEST(Rosette, FillsItsRoundFieldAndNothingElse) {
  const SensorModel sensor = rosette_sensor();
  ASSERT_EQ(sensor.pattern.size(), 24'000U);
  double widest = 0.0;
  std::set<std::pair<int, int>> cells;
  for (std::size_t scan = 0; scan < 10; ++scan) {
    for (std::size_t i = 0; i < sensor.pattern.size(); ++i) {
      const Beam shot = beam(sensor, scan, i);
      widest = std::max(widest, std::acos(shot.direction.x()));
      cells.emplace(static_cast<int>(std::floor(azimuth(shot) / (2 * degree))),
                    static_cast<int>(std::floor(elevation(shot) / (2 * degree))));
    }
  }
  EXPECT_LE(widest, 35.0 * degree + 1e-9);
  EXPECT_GT(widest, 34.9 * degree);
  const double whole_field = std::numbers::pi * 35.0 * 35.0 / 4.0;  // cells of 2 degrees
  EXPECT_GT(static_cast<double>(cells.size()), 0.97 * whole_field);
}

TEST(Rosette, DoesNotRepeatItself) {
  const SensorModel sensor = rosette_sensor();
  const auto differs = [&](std::size_t i) {
    return (beam(sensor, 0, i).direction - beam(sensor, 1, i).direction).norm() > 1.0 * degree;
  };
  int different = 0;
  for (std::size_t i = 0; i < sensor.pattern.size(); ++i) different += differs(i) ? 1 : 0;
  EXPECT_GT(different, 20'000);
}

TEST(Raster, CoversItsField) {
  const SensorModel sensor = raster_sensor();
  ASSERT_EQ(sensor.pattern.size(), 64U * 480U);
  const auto [low, high] = std::ranges::minmax(sensor.pattern, {}, elevation);
  EXPECT_NEAR(elevation(low), -10.0 * degree, 1e-9);
  EXPECT_NEAR(elevation(high), 10.0 * degree, 1e-9);
  const auto [right, left] = std::ranges::minmax(sensor.pattern, {}, azimuth);
  EXPECT_NEAR(azimuth(left), 60.0 * degree, 0.2 * degree);
  EXPECT_NEAR(azimuth(right), -60.0 * degree, 0.2 * degree);
}

TEST(Sensors, RefuseWhatTheyAreNot) {
  EXPECT_THROW(spinning_sensor(17), Error);
  EXPECT_THROW(spinning_sensor(16, -1), Error);
  EXPECT_THROW(sensor_by_name("sonar"), Error);
  EXPECT_THROW(sensor_by_name("rosette", 100), Error);
}

}  // namespace
}  // namespace kissmap::simulator
