// SPDX-License-Identifier: MIT
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <string>
#include <vector>

namespace kissmap::simulator {

/// One shot of a sweep.
struct Beam {
  Eigen::Vector3d direction = Eigen::Vector3d::UnitX();  ///< unit, lidar frame
  double time_offset = 0.0;                              ///< s after the start of the sweep
};

/// Two prisms turning against each other (Livox-like): each bends the beam by half the half-angle
/// of the field, so the beam draws rosettes that differ from sweep to sweep.
struct Rosette {
  double half_angle = 0.0;       ///< rad; 0: not a rosette sensor
  double first_turns = 121.57;   ///< 1/s
  double second_turns = -77.73;  ///< 1/s
};

/// A LiDAR. Plain data: change noise or range after making one.
struct SensorModel {
  std::string name;
  double period = 0.1;        ///< s per sweep
  double min_range = 0.5;     ///< m; nearer returns vanish
  double max_range = 120.0;   ///< m; beyond, a beam has no return
  double range_noise = 0.02;  ///< m, standard deviation
  double dropout = 0.02;      ///< share of returns that vanish at random
  std::vector<Beam> pattern;  ///< of every sweep; a rosette uses only the times
  Rosette rosette;
};

/// The beam as fired in sweep `scan_idx`.
Beam beam(const SensorModel& sensor, std::size_t scan_idx, std::size_t beam_idx);

/// A turn that starts at the rear and goes clockwise seen from above (left, front, right), all
/// rings of a column at once, lowest first. `columns` = 0 takes the usual number.
/// 16 rings: +-15 deg, 900 columns (like a VLP-16); 32: -30..+10 deg, 1024 columns (HDL-32);
/// 64: +-22.5 deg, 1024 columns (OS1-64). 10 Hz. Throws Error(usage) for other numbers of rings.
SensorModel spinning_sensor(int rings, int columns = 0);

/// Round field of 70 degrees, 24,000 shots in 0.1 s, never repeating.
SensorModel rosette_sensor();

/// 120 x 20 degrees, 64 lines to and fro from top to bottom in 0.1 s, `columns` = 0 takes 480.
SensorModel raster_sensor(int columns = 0);

/// By name: spinning16, spinning32, spinning64, rosette or raster. Throws Error(usage) otherwise,
/// or for columns with a rosette.
SensorModel sensor_by_name(const std::string& name, int columns = 0);

}  // namespace kissmap::simulator
