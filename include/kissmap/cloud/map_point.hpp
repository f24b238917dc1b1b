// SPDX-License-Identifier: MIT
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <limits>

namespace kissmap {

/// A return in its place on the map, and how it came to be seen.
struct MapPoint {
  Eigen::Vector3d position = Eigen::Vector3d::Zero();         ///< m, map frame
  double time = 0.0;                                          ///< s since the log's epoch
  Eigen::Vector3f to_sensor = Eigen::Vector3f::Zero();        ///< m, map axes, from point to sensor
  float intensity = std::numeric_limits<float>::quiet_NaN();  ///< the sensor's own unit
  std::uint32_t scan_idx = 0;                                 ///< among the scans of the session
};

}  // namespace kissmap
