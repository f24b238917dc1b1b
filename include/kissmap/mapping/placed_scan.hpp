// SPDX-License-Identifier: MIT
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <vector>

#include "kissmap/cloud/scan.hpp"
#include "kissmap/geometry/rigid3.hpp"
#include "kissmap/mapping/local_map.hpp"

namespace kissmap {

/// A scan with each point where a trajectory puts it, and the sensor where it was then. All in the
/// lidar frame at pose_stamp_ns, so that single precision is enough anywhere:
/// map_from_lidar * point is where it lies.
struct PlacedScan {
  std::uint64_t scan_idx = 0;  ///< among the scans of its session
  std::int64_t pose_stamp_ns = 0;
  Rigid3 map_from_lidar;

  std::vector<Eigen::Vector3f> points;   ///< m, deskewed where the scan has times
  std::vector<Eigen::Vector3f> origins;  ///< m, parallel: the sensor when it saw the point
  std::vector<float> intensities;        ///< parallel, or empty
  std::vector<float> time_offsets;       ///< s after pose_stamp_ns, parallel, or empty

  /// Of shots that nothing came back of, where they were asked for: see place_no_returns().
  std::vector<Eigen::Vector3f> no_return_directions;  ///< unit
  std::vector<Eigen::Vector3f> no_return_origins;     ///< m, parallel
};

/// Motion through the sweep that ends at `scan`, at the constant velocity from the scan before to
/// this one; the sweep motion odometry assumed where there is none before it or it is too far back
/// (three sweeps). `sweep_seconds` is how long the sweep took.
Rigid3 sweep_start_from_sweep_end(const MappedScan* before,
                                  const MappedScan& scan,
                                  double sweep_seconds);

/// Places the points whose range after deskewing is between min_range and max_range [m]. `before`
/// is the scan placed before this one, null for the first. Deskews where odometry did. Shots
/// without a return are left out: few ask for them, and outdoors they are half of all. Pure.
PlacedScan place_scan(const Scan& scan,
                      const MappedScan* before,
                      const MappedScan& mapped,
                      double min_range,
                      double max_range);

/// Adds the shots without a return to a scan that was placed by the same arguments.
void place_no_returns(const Scan& scan,
                      const MappedScan* before,
                      const MappedScan& mapped,
                      PlacedScan& placed);

}  // namespace kissmap
