// SPDX-License-Identifier: MIT
#include "kissmap/evaluation/alignment.hpp"

#include <Eigen/SVD>
#include <algorithm>
#include <cmath>

namespace kissmap {
namespace {

// Spread of positions across a line, relative to that along it, below which it is rounding.
constexpr double open_rotation = 1e-12;  // of variances: 1 mm in 1 km
// Spread relative to the distance from the origin, below which positions are all the same.
constexpr double same_place = 1e-12;

Eigen::Vector3d mean_position(const std::vector<Rigid3>& poses) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const Rigid3& pose : poses) sum += pose.translation;
  return sum / static_cast<double>(poses.size());
}

struct Moments {
  Eigen::Vector3d reference_mean;
  Eigen::Vector3d estimate_mean;
  Eigen::Matrix3d covariance;  ///< reference times estimate transposed
  double zero = 0.0;           ///< what is as small is rounding
};

Moments moments_of(const std::vector<Rigid3>& reference, const std::vector<Rigid3>& estimate) {
  Moments m{mean_position(reference), mean_position(estimate), Eigen::Matrix3d::Zero()};
  double reference_size = 0.0;
  double estimate_size = 0.0;
  for (std::size_t i = 0; i < reference.size(); ++i) {
    const Eigen::Vector3d r = reference[i].translation - m.reference_mean;
    const Eigen::Vector3d e = estimate[i].translation - m.estimate_mean;
    m.covariance += r * e.transpose();
    reference_size += r.squaredNorm();
    estimate_size += e.squaredNorm();
  }
  m.covariance /= static_cast<double>(reference.size());
  const double spread =
      std::sqrt(reference_size * estimate_size) / static_cast<double>(reference.size());
  const double rounding = same_place * (m.reference_mean.norm() + m.estimate_mean.norm());
  m.zero = std::max(open_rotation * spread, rounding * rounding);
  return m;
}

Rigid3 with_rotation(const Eigen::Quaterniond& rotation, const Moments& m) {
  return {rotation, m.reference_mean - rotation * m.estimate_mean};
}

// Umeyama 1991, eqs. 34-43, scale 1.
std::optional<Rigid3> align_se3(const Moments& m) {
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(m.covariance,
                                              Eigen::ComputeFullU | Eigen::ComputeFullV);
  if (svd.singularValues()[1] <= m.zero) return std::nullopt;
  const Eigen::Matrix3d& u = svd.matrixU();
  const Eigen::Matrix3d& v = svd.matrixV();
  Eigen::Vector3d signs = Eigen::Vector3d::Ones();
  if (u.determinant() * v.determinant() < 0.0) signs.z() = -1.0;
  const Eigen::Matrix3d rotation = u * signs.asDiagonal() * v.transpose();
  return with_rotation(Eigen::Quaterniond(rotation).normalized(), m);
}

// The best rotation about z turns the sum of all products in the plane to the real axis.
std::optional<Rigid3> align_yaw(const Moments& m) {
  const double along = m.covariance(0, 0) + m.covariance(1, 1);
  const double across = m.covariance(1, 0) - m.covariance(0, 1);
  if (std::hypot(along, across) <= m.zero) return std::nullopt;
  const Eigen::AngleAxisd rotation(std::atan2(across, along), Eigen::Vector3d::UnitZ());
  return with_rotation(Eigen::Quaterniond(rotation), m);
}

}  // namespace

std::optional<Rigid3> align(const std::vector<Rigid3>& reference,
                            const std::vector<Rigid3>& estimate,
                            MapAlignment alignment) {
  if (alignment == MapAlignment::none) return Rigid3{};
  if (reference.empty() || reference.size() != estimate.size()) return std::nullopt;
  if (alignment == MapAlignment::first) return reference.front() * estimate.front().inverse();
  const Moments moments = moments_of(reference, estimate);
  return alignment == MapAlignment::yaw ? align_yaw(moments) : align_se3(moments);
}

std::vector<Rigid3> transformed(const Rigid3& a_from_b, const std::vector<Rigid3>& b_from_c) {
  std::vector<Rigid3> result;
  result.reserve(b_from_c.size());
  for (const Rigid3& pose : b_from_c) result.push_back(a_from_b * pose);
  return result;
}

}  // namespace kissmap
