// SPDX-License-Identifier: MIT
#pragma once

#include <Eigen/Geometry>
#include <filesystem>
#include <vector>

#include "support/laser_robot.hpp"

namespace kissmap {

/// Writes the drive of a laser robot as MRPT's rawlog: odometry increments and 2D range scans.
void write_rawlog(const std::vector<LaserStep>& steps,
                  const LaserRobotOptions& robot,
                  const std::filesystem::path& path);

/// Converts map.yaml with ros-map-yaml2mrpt and localises the drive in it with pf-localization,
/// started uniformly over the free cells of `start`, looking anywhere. Returns what it says about
/// itself: after each step, the weighted mean distance [m] of its particles from the truth. It
/// draws its own random numbers, so this differs a little from run to run. All files go to
/// `folder`. Throws Error(input) with what the programs said where one of them fails.
std::vector<double> localise_with_mrpt(const std::filesystem::path& map_yaml,
                                       const std::vector<LaserStep>& steps,
                                       const LaserRobotOptions& robot,
                                       const Eigen::AlignedBox2d& start,
                                       const std::filesystem::path& folder);

/// Distances from the truth [m] that are asked for.
struct ErrorBounds {
  double least = 0.0;
  double most = 0.0;
};

/// The median of localise_with_mrpt() over the second half of the drive: that of the first of three
/// attempts which lies within the bounds, or of the last. From some of its random numbers MRPT's
/// 2,000 particles lose the way, wherever the map lies.
double median_error_with_mrpt(const std::filesystem::path& map_yaml,
                              const std::vector<LaserStep>& steps,
                              const LaserRobotOptions& robot,
                              const Eigen::AlignedBox2d& start,
                              const std::filesystem::path& folder,
                              const ErrorBounds& bounds);

}  // namespace kissmap
