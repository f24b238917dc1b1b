// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cstddef>
#include <filesystem>
#include <string_view>

namespace kissmap {

/// Corrections of one laser of an HDL-64E, as its maker measured them: angles in rad, lengths in m,
/// but for the focal distance, which is in the unit of the maker's formula.
struct Hdl64eLaser {
  double rotation = 0.0;
  double elevation = 0.0;
  double distance = 0.0;         ///< added to every distance
  bool two_points = false;       ///< the two below are known
  double distance_at_x = 0.0;    ///< in place of `distance` at a wall 2.40 m away along x
  double distance_at_y = 0.0;    ///< and at one 1.93 m away along y
  double vertical_offset = 0.0;  ///< of the laser, from the sensor's origin
  double horizontal_offset = 0.0;
  double focal_distance = 0.0;
  double focal_slope = 0.0;
  double least_intensity = 0.0;
  double most_intensity = 255.0;
};

inline constexpr std::size_t hdl_64e_lasers = 64;

/// By number of the laser; the upper bank, marked 0xEEFF, has 0 to 31.
using Hdl64eCalibration = std::array<Hdl64eLaser, hdl_64e_lasers>;

/// Reads the YAML file that the ROS driver (velodyne_pointcloud, gen_calibration.py) makes from the
/// db.xml that came with the sensor. `origin` names it in errors. Throws Error(input) naming laser
/// and key.
Hdl64eCalibration read_hdl_64e_calibration(std::string_view yaml,
                                           const std::filesystem::path& origin);

}  // namespace kissmap
