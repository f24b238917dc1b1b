// SPDX-License-Identifier: MIT
#include "kissmap/geometry/rigid3.hpp"

#include <Eigen/SVD>
#include <cmath>

namespace kissmap {
namespace {

Eigen::Matrix3d cross_matrix(const Eigen::Vector3d& v) {
  Eigen::Matrix3d m;
  m << 0, -v.z(), v.y(), v.z(), 0, -v.x(), -v.y(), v.x(), 0;
  return m;
}

// Rotation vector, angle in 0..pi. atan2 of the quaternion's parts stays accurate near 0 and pi.
Eigen::Vector3d rotation_vector(const Eigen::Quaterniond& rotation) {
  const double sign = rotation.w() < 0 ? -1.0 : 1.0;
  const double sin_half = rotation.vec().norm();
  const double half = std::atan2(sin_half, sign * rotation.w());
  const double scale = sin_half < 1e-12 ? 2.0 : 2.0 * half / sin_half;
  return sign * scale * rotation.vec();
}

}  // namespace

Rigid3 Rigid3::inverse() const {
  const Eigen::Quaterniond inverse_rotation = rotation.conjugate();
  return {inverse_rotation, -(inverse_rotation * translation)};
}

Rigid3 Rigid3::operator*(const Rigid3& other) const {
  return {(rotation * other.rotation).normalized(), rotation * other.translation + translation};
}

Eigen::Vector3d Rigid3::operator*(const Eigen::Vector3d& point) const {
  return rotation * point + translation;
}

Eigen::Matrix4d Rigid3::matrix() const {
  Eigen::Matrix4d m = Eigen::Matrix4d::Identity();
  m.topLeftCorner<3, 3>() = rotation.toRotationMatrix();
  m.topRightCorner<3, 1>() = translation;
  return m;
}

double Rigid3::angle() const {
  return 2.0 * std::atan2(rotation.vec().norm(), std::abs(rotation.w()));
}

Rigid3 Rigid3::from_matrix(const Eigen::Matrix<double, 3, 4>& matrix) {
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(matrix.leftCols<3>(),
                                              Eigen::ComputeFullU | Eigen::ComputeFullV);
  Eigen::Vector3d signs = Eigen::Vector3d::Ones();
  signs.z() = (svd.matrixU() * svd.matrixV().transpose()).determinant() < 0 ? -1.0 : 1.0;
  const Eigen::Matrix3d rotation = svd.matrixU() * signs.asDiagonal() * svd.matrixV().transpose();
  return {Eigen::Quaterniond(rotation).normalized(), matrix.col(3)};
}

Rigid3 exp(const Twist& twist) {
  const Eigen::Vector3d phi = twist.tail<3>();
  const double angle = phi.norm();
  const Eigen::Matrix3d k = cross_matrix(phi);
  // Coefficients of the left Jacobian; series below 1e-4 rad, where the quotients lose digits.
  const double a2 = angle * angle;
  const bool small = angle < 1e-4;
  const double b = small ? 0.5 - a2 / 24.0 : (1.0 - std::cos(angle)) / a2;
  const double c = small ? 1.0 / 6.0 - a2 / 120.0 : (angle - std::sin(angle)) / (a2 * angle);
  const Eigen::Matrix3d left_jacobian = Eigen::Matrix3d::Identity() + b * k + c * k * k;
  const double sinc_half = small ? 0.5 - a2 / 48.0 : std::sin(0.5 * angle) / angle;
  Eigen::Quaterniond rotation;
  rotation.w() = std::cos(0.5 * angle);
  rotation.vec() = sinc_half * phi;
  return {rotation.normalized(), left_jacobian * twist.head<3>()};
}

Twist log(const Rigid3& transform) {
  const Eigen::Vector3d phi = rotation_vector(transform.rotation);
  const double angle = phi.norm();
  const Eigen::Matrix3d k = cross_matrix(phi);
  const double half = 0.5 * angle;
  const double d = angle < 1e-4 ? 1.0 / 12.0 + angle * angle / 720.0
                                : (1.0 - half / std::tan(half)) / (angle * angle);
  const Eigen::Matrix3d inverse_left_jacobian = Eigen::Matrix3d::Identity() - 0.5 * k + d * k * k;
  Twist twist;
  twist << inverse_left_jacobian * transform.translation, phi;
  return twist;
}

}  // namespace kissmap
