// SPDX-License-Identifier: MIT
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "kissmap/geometry/rigid3.hpp"
#include "kissmap/mapping/placed_scan.hpp"
#include "kissmap/occupancy/occupancy_map.hpp"

namespace kissmap::occupancy {

/// The arrays that a RayScan looks at.
struct ScanRays {
  Eigen::Vector3d offset = Eigen::Vector3d::Zero();  ///< m
  std::vector<Eigen::Vector3f> starts;               ///< m, relative to offset
  std::vector<Eigen::Vector3f> ends;                 ///< m, relative to offset
  std::vector<std::uint8_t> is_hit;
  std::vector<float> margins;  ///< m

  RayScan view() const { return {offset, starts, ends, is_hit, margins}; }
};

/// The rays of a scan, turned into the frame that frame_from_lidar leads to; offset is where that
/// puts the lidar. Those without a return follow the others and end no_return_range [m] from the
/// sensor; none of them if that is 0. Margins are left empty.
ScanRays rays_of(const PlacedScan& scan, const Rigid3& frame_from_lidar, double no_return_range);

}  // namespace kissmap::occupancy
