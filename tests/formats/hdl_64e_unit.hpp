// SPDX-License-Identifier: MIT
// Units of the HDL-64E that do not exist, and their packets and files.
#pragma once

#include <cstddef>
#include <cstdint>
#include <random>
#include <sstream>
#include <string>

#include "formats/sensors/hdl_64e_calibration.hpp"
#include "formats/velodyne_packets.hpp"

namespace kissmap::test {

/// A packet as the manual lays it out: upper and lower bank in turns. `blocks` are those of a
/// column, four where each shot has two returns.
inline VelodynePacket hdl_64e_packet(std::uint32_t us,
                                     long first_steps,
                                     long steps_a_column,
                                     std::size_t blocks = 2) {
  VelodynePacket made(0x17, 0x00, us);
  for (std::size_t block = 0; block < VelodynePacket::blocks; ++block) {
    made.mark(block, block % 2 == 0 ? 0xEEFF : 0xDDFF);
    made.azimuth(block, first_steps + static_cast<long>(block / blocks) * steps_a_column);
  }
  return made;
}

inline Hdl64eCalibration random_calibration(unsigned seed) {
  std::mt19937 random(seed);
  const auto within = [&](double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random);
  };
  Hdl64eCalibration calibration;
  for (Hdl64eLaser& laser : calibration) {
    laser.rotation = within(-0.15, 0.15);
    laser.elevation = within(-0.44, 0.04);
    laser.distance = within(0.9, 1.5);
    laser.two_points = true;
    laser.distance_at_x = laser.distance + within(-0.05, 0.05);
    laser.distance_at_y = laser.distance + within(-0.05, 0.05);
    laser.vertical_offset = within(0.15, 0.22);
    laser.horizontal_offset = within(-0.03, 0.03);
    laser.focal_distance = within(0.0, 2000.0);
    laser.focal_slope = within(0.8, 1.6);
  }
  return calibration;
}

/// As gen_calibration.py of the ROS driver writes it.
inline std::string yaml_of(const Hdl64eCalibration& calibration) {
  std::ostringstream text;
  text.precision(17);
  text << "lasers:\n";
  for (std::size_t i = 0; i < calibration.size(); ++i) {
    const std::size_t id = calibration.size() - 1 - i;  // any order
    const Hdl64eLaser& laser = calibration[id];
    text << "- {dist_correction: " << laser.distance
         << ", dist_correction_x: " << laser.distance_at_x
         << ", dist_correction_y: " << laser.distance_at_y
         << ", focal_distance: " << laser.focal_distance << ", focal_slope: " << laser.focal_slope
         << ", horiz_offset_correction: " << laser.horizontal_offset << ", laser_id: " << id
         << ", max_intensity: " << laser.most_intensity
         << ", min_intensity: " << laser.least_intensity << ", rot_correction: " << laser.rotation
         << ", two_pt_correction_available: true, vert_correction: " << laser.elevation
         << ", vert_offset_correction: " << laser.vertical_offset << "}\n";
  }
  text << "num_lasers: 64\ndistance_resolution: 0.002\n";
  return text.str();
}

}  // namespace kissmap::test
