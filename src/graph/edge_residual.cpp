// SPDX-License-Identifier: MIT
#include "graph/edge_residual.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <cmath>

namespace kissmap {
namespace {

using Eigen::Matrix3d;
using Eigen::Quaterniond;
using Eigen::Vector3d;

Matrix3d cross_matrix(const Vector3d& v) {
  Matrix3d m;
  m << 0, -v.z(), v.y(), v.z(), 0, -v.x(), -v.y(), v.x(), 0;
  return m;
}

Rigid3 disagreement(const Rigid3& from_from_to, const Rigid3& from_from_to_now) {
  Rigid3 d = from_from_to.inverse() * from_from_to_now;
  if (d.rotation.w() < 0.0) d.rotation.coeffs() *= -1.0;
  return d;
}

Vector3d rotation_error(const Quaterniond& q, GraphSpace space) {
  Vector3d chord = 2.0 * q.vec();
  if (space == GraphSpace::spatial) return chord;
  const double sine = q.vec().norm();
  return sine < 1e-12 ? chord : Vector3d(std::atan2(sine, q.w()) / sine * chord);
}

// Derivative of the rotation error by a small rotation behind q; its transpose is the one before q.
Matrix3d rotation_derivative(const Quaterniond& q, GraphSpace space) {
  if (space == GraphSpace::spatial) return q.w() * Matrix3d::Identity() + cross_matrix(q.vec());
  const Vector3d phi = rotation_error(q, space);
  const Matrix3d k = cross_matrix(phi);
  const double half = 0.5 * phi.norm();
  const double c = half < 1e-4 ? 1.0 / 12.0 : (1.0 - half / std::tan(half)) / (4.0 * half * half);
  return Matrix3d::Identity() + 0.5 * k + c * k * k;
}

}  // namespace

Matrix6 square_root(const Information& information) {
  const Eigen::LLT<Matrix6> cholesky(information);
  if (cholesky.info() == Eigen::Success) return cholesky.matrixU();
  const Eigen::SelfAdjointEigenSolver<Matrix6> eigen(information);
  return eigen.eigenvalues().cwiseMax(0.0).cwiseSqrt().asDiagonal() *
         eigen.eigenvectors().transpose();
}

Twist edge_error(const Rigid3& from_from_to,
                 const Rigid3& map_from_from,
                 const Rigid3& map_from_to,
                 GraphSpace space) {
  const Rigid3 d = disagreement(from_from_to, map_from_from.inverse() * map_from_to);
  Twist error;
  error << d.translation, rotation_error(d.rotation, space);
  return error;
}

EdgeResidual edge_residual(const Rigid3& from_from_to,
                           const Rigid3& map_from_from,
                           const Rigid3& map_from_to,
                           GraphSpace space) {
  const Rigid3 now = map_from_from.inverse() * map_from_to;
  const Rigid3 d = disagreement(from_from_to, now);
  const Matrix3d to_from_from = from_from_to.rotation.conjugate().toRotationMatrix();
  const Matrix3d turn = rotation_derivative(d.rotation, space);
  EdgeResidual r;
  r.error << d.translation, rotation_error(d.rotation, space);
  r.by_to.setZero();
  r.by_to.topLeftCorner<3, 3>() = d.rotation.toRotationMatrix();
  r.by_to.bottomRightCorner<3, 3>() = turn;
  r.by_from.setZero();
  r.by_from.topLeftCorner<3, 3>() = -to_from_from;
  r.by_from.topRightCorner<3, 3>() = to_from_from * cross_matrix(now.translation);
  r.by_from.bottomRightCorner<3, 3>() = -turn.transpose() * to_from_from;
  return r;
}

Rigid3 stepped(const Rigid3& pose, const Twist& step) {
  const Vector3d phi = step.tail<3>();
  const double half = 0.5 * phi.norm();
  Quaterniond turn;
  turn.w() = std::cos(half);
  turn.vec() = half < 1e-9 ? Vector3d(0.5 * phi) : Vector3d(0.5 * std::sin(half) / half * phi);
  return {(pose.rotation * turn).normalized(), pose.translation + pose.rotation * step.head<3>()};
}

}  // namespace kissmap
