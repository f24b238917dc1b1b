// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "kissmap/geometry/rigid3.hpp"

namespace kissmap {

/// Where a scan was taken, relative to the keypose of its local map.
struct ScanPlace {
  std::uint32_t local_map_id = 0;
  Rigid3 local_map_from_lidar;
};

/// How surely the odometry knows the motion between two scans: variances grow with the way gone.
/// Only their ratios matter.
struct SpreadOptions {
  double metres_per_sqrt_metre = 0.01;    ///< standard deviation of each translation after 1 m
  double radians_per_sqrt_metre = 0.001;  ///< and of each rotation
  double least_way = 0.05;                ///< m, counted for a scan that did not move
};

/// Throws Error(usage) naming the option.
void require_valid(const SpreadOptions& options);

/// map_from_lidar of every scan once the keyposes have been corrected: between two keyposes the
/// correction is spread over the scans by least squares over the motions the odometry found, as a
/// pose graph with one node a scan whose ends are held. The last local map moves as a rigid body.
///
/// `scans` ascend by local map; ids are indices of the keyposes, map_from_local_map. The last scan
/// of a local map is where the next keypose was; if it was not quite there, it keeps that offset.
/// Throws Error(input) for ids out of range or order, for poses that are not finite, and when the
/// two sets of keyposes are not equally many. Takes time proportional to the number of scans.
/// One thread, the same result on every run. Thread safe.
std::vector<Rigid3> spread_corrections(std::span<const ScanPlace> scans,
                                       const std::vector<Rigid3>& keyposes_before,
                                       const std::vector<Rigid3>& keyposes_after,
                                       const SpreadOptions& options = {});

}  // namespace kissmap
