// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <vector>

#include "simulator/motion.hpp"
#include "simulator/ray_caster.hpp"
#include "support/occupancy_plan.hpp"

namespace kissmap {

/// A robot with a planar laser scanner, level at a fixed height, and wheels that slip.
struct LaserRobotOptions {
  double height = 0.3;          ///< m above z = 0
  int beams = 360;              ///< beam k looks at -pi + 2 pi k / beams from straight ahead
  double max_range = 20.0;      ///< m
  double range_noise = 0.02;    ///< m, standard deviation
  double step = 0.2;            ///< m between scans
  double turn = 0.2;            ///< rad between scans, whichever comes first
  double slip_distance = 0.03;  ///< standard deviation, part of the distance of a step
  double slip_turn = 0.03;      ///< standard deviation, part of the turn of a step
  double slip_heading = 0.01;   ///< rad per metre driven, standard deviation
  double start = 0.0;           ///< s into the motion
  double distance = 60.0;       ///< m to drive, if the motion is so long
  std::uint64_t seed = 1;       ///< of the noise
};

/// One scan, all beams at once.
struct LaserStep {
  double time = 0.0;          ///< s
  Pose2 world_from_robot;     ///< the truth
  Pose2 odometry_from_robot;  ///< what the wheels tell; starts at the origin
  std::vector<float> ranges;  ///< m; 0 where nothing is within range
};

/// Drives along `motion`, of which only x, y and yaw count. The same steps for the same seed.
std::vector<LaserStep> drive_laser_robot(const simulator::RayCaster& caster,
                                         const simulator::Motion& motion,
                                         const LaserRobotOptions& options);

}  // namespace kissmap
