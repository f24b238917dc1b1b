// SPDX-License-Identifier: MIT
#include "simulator/sensor.hpp"

#include <cmath>
#include <numbers>

#include "kissmap/error.hpp"

namespace kissmap::simulator {
namespace {

constexpr double pi = std::numbers::pi;
constexpr double degree = pi / 180.0;

struct RingFacts {
  int rings;
  double lowest;   // rad
  double highest;  // rad
  int columns;
  double max_range;  // m
};

RingFacts ring_facts(int rings) {
  switch (rings) {
    case 16:
      return {16, -15 * degree, 15 * degree, 900, 100.0};
    case 32:
      return {32, -30 * degree, 10 * degree, 1024, 100.0};
    case 64:
      return {64, -22.5 * degree, 22.5 * degree, 1024, 120.0};
    default:
      throw usage_error("a spinning sensor has 16, 32 or 64 rings, not " + std::to_string(rings));
  }
}

Eigen::Vector3d direction(double azimuth, double elevation) {
  return {std::cos(elevation) * std::cos(azimuth),
          std::cos(elevation) * std::sin(azimuth),
          std::sin(elevation)};
}

int columns_or(int columns, int usual) {
  if (columns < 0) throw usage_error("the number of columns is negative");
  return columns == 0 ? usual : columns;
}

}  // namespace

Beam beam(const SensorModel& sensor, std::size_t scan_idx, std::size_t beam_idx) {
  Beam shot = sensor.pattern[beam_idx];
  const Rosette& rosette = sensor.rosette;
  if (rosette.half_angle <= 0.0) return shot;
  const double time = static_cast<double>(scan_idx) * sensor.period + shot.time_offset;
  const double first = 2.0 * pi * rosette.first_turns * time;
  const double second = 2.0 * pi * rosette.second_turns * time;
  const double bend = 0.5 * rosette.half_angle;
  const double y = bend * (std::cos(first) + std::cos(second));
  const double z = bend * (std::sin(first) + std::sin(second));
  const double off_axis = std::hypot(y, z);
  const double scale = off_axis < 1e-9 ? 1.0 : std::sin(off_axis) / off_axis;
  shot.direction = {std::cos(off_axis), scale * y, scale * z};
  return shot;
}

SensorModel spinning_sensor(int rings, int columns) {
  const RingFacts facts = ring_facts(rings);
  SensorModel sensor;
  sensor.name = "spinning" + std::to_string(rings);
  sensor.max_range = facts.max_range;
  const int n = columns_or(columns, facts.columns);
  for (int column = 0; column < n; ++column) {
    const double turn = (column + 0.5) / n;
    for (int ring = 0; ring < rings; ++ring) {
      const double part = static_cast<double>(ring) / (rings - 1);
      const double elevation = facts.lowest + part * (facts.highest - facts.lowest);
      sensor.pattern.push_back({direction(pi - 2.0 * pi * turn, elevation), turn * sensor.period});
    }
  }
  return sensor;
}

SensorModel rosette_sensor() {
  constexpr int shots = 24'000;
  SensorModel sensor;
  sensor.name = "rosette";
  sensor.rosette.half_angle = 35 * degree;
  for (int shot = 0; shot < shots; ++shot) {
    sensor.pattern.push_back({Eigen::Vector3d::UnitX(), (shot + 0.5) / shots * sensor.period});
  }
  return sensor;
}

SensorModel raster_sensor(int columns) {
  constexpr int lines = 64;
  const int n = columns_or(columns, 480);
  SensorModel sensor;
  sensor.name = "raster";
  for (int line = 0; line < lines; ++line) {
    const double elevation = (10.0 - 20.0 * line / (lines - 1)) * degree;
    for (int i = 0; i < n; ++i) {
      const int column = line % 2 == 0 ? i : n - 1 - i;
      const double azimuth = (60.0 - 120.0 * (column + 0.5) / n) * degree;
      const double turn =
          (static_cast<double>(line) * n + i + 0.5) / (static_cast<double>(lines) * n);
      sensor.pattern.push_back({direction(azimuth, elevation), turn * sensor.period});
    }
  }
  return sensor;
}

SensorModel sensor_by_name(const std::string& name, int columns) {
  if (name == "spinning16") return spinning_sensor(16, columns);
  if (name == "spinning32") return spinning_sensor(32, columns);
  if (name == "spinning64") return spinning_sensor(64, columns);
  if (name == "raster") return raster_sensor(columns);
  if (name != "rosette") {
    throw usage_error("unknown sensor " + name +
                      "; choose spinning16, spinning32, spinning64, rosette or raster");
  }
  if (columns != 0) throw usage_error("a rosette sensor has no columns");
  return rosette_sensor();
}

}  // namespace kissmap::simulator
