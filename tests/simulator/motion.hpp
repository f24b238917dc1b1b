// SPDX-License-Identifier: MIT
#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

#include "kissmap/geometry/rigid3.hpp"

namespace kissmap::simulator {

/// x, y, z [m], roll, pitch, yaw [rad]: rotation = Rz(yaw) Ry(pitch) Rx(roll). Yaw is unwrapped:
/// a whole turn adds 2 pi.
using PoseVector = Eigen::Matrix<double, 6, 1>;
Rigid3 rigid_from(const PoseVector& pose);

/// One sine of the carrier's own shaking, as an offset in its body frame.
struct Wobble {
  PoseVector amplitude = PoseVector::Zero();  ///< m and rad
  double frequency = 1.0;                     ///< Hz
  double phase = 0.0;                         ///< rad
};

/// A smooth (C2) motion: a uniform cubic B-spline through planned poses, plus wobbles, plus the
/// place of the LiDAR on its carrier. Plain data; before its start and after its end it stands
/// still, apart from the wobbles.
struct Motion {
  double interval = 0.1;            ///< s between control poses
  std::vector<PoseVector> control;  ///< world_from_body; the first is at time 0
  std::vector<Wobble> wobbles;
  Rigid3 body_from_lidar;

  double duration() const;  ///< s
  Rigid3 world_from_lidar(double time) const;
};

}  // namespace kissmap::simulator
