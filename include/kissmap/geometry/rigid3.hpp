// SPDX-License-Identifier: MIT
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace kissmap {

/// Rigid transform of 3D space. A value named `a_from_b` maps coordinates in frame b (metres) to
/// coordinates in frame a, so names cancel: a_from_c = a_from_b * b_from_c.
struct Rigid3 {
  Eigen::Quaterniond rotation = Eigen::Quaterniond::Identity();  ///< unit length
  Eigen::Vector3d translation = Eigen::Vector3d::Zero();         ///< m

  Rigid3 inverse() const;
  Rigid3 operator*(const Rigid3& other) const;  ///< renormalises the rotation
  Eigen::Vector3d operator*(const Eigen::Vector3d& point) const;
  Eigen::Matrix4d matrix() const;

  /// Angle of the rotation [rad], 0..pi.
  double angle() const;

  /// From a 3x4 or 4x4 [R | t]; R is projected to the nearest rotation.
  static Rigid3 from_matrix(const Eigen::Matrix<double, 3, 4>& matrix);
};

/// Tangent vector of SE(3): (translation [m]; rotation [rad]).
using Twist = Eigen::Matrix<double, 6, 1>;

/// Exponential and logarithm of SE(3) (Barfoot, State Estimation for Robotics, eqs. 7.63-7.95):
/// exp(log(x)) = x, and exp(s * log(x)) is the constant-velocity motion from identity to x.
Rigid3 exp(const Twist& twist);
Twist log(const Rigid3& transform);

}  // namespace kissmap
