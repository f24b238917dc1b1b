// SPDX-License-Identifier: MIT
#pragma once

#include <Eigen/Core>
#include <vector>

#include "simulator/motion.hpp"

namespace kissmap::simulator {

/// How a carrier follows a route.
struct DrivingStyle {
  double max_speed = 10.0;             ///< m/s
  double acceleration = 1.5;           ///< m/s^2
  double braking = 2.0;                ///< m/s^2
  double lateral_acceleration = 2.0;   ///< m/s^2; slows down in corners
  double turn_rate = 0.7;              ///< rad/s; slows down in sharp corners
  double corner_radius = 7.0;          ///< m
  double corner_smoothing = 3.0;       ///< m over which steering turns in
  double pitch_by_acceleration = 0.0;  ///< rad per m/s^2, nose up when accelerating
  double roll_by_acceleration = 0.0;   ///< rad per m/s^2, leaning out of the corner
  double interval = 0.1;               ///< s between the poses of the plan
};

/// Poses from rest to rest along a polyline with rounded corners, heading along the way and
/// pitched with its slope. Needs two different points or more, and a way that never doubles back
/// on itself: where it does, the heading jumps.
std::vector<PoseVector> drive(const std::vector<Eigen::Vector3d>& way_points,
                              const DrivingStyle& style);

/// The same without rounding: stops at each corner and turns in place, at style.turn_rate at most.
std::vector<PoseVector> drive_with_turns_in_place(const std::vector<Eigen::Vector3d>& way_points,
                                                  const DrivingStyle& style);

}  // namespace kissmap::simulator
