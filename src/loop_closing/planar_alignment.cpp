// SPDX-License-Identifier: MIT
#include "kissmap/loop_closing/planar_alignment.hpp"

#include <Eigen/Geometry>
#include <cmath>
#include <vector>

#include "random_bits.hpp"

namespace kissmap {
namespace {

constexpr double success = 0.999;
constexpr double inlier_ratio = 0.1;
constexpr int refits = 3;

int trials() {
  return static_cast<int>(
      std::ceil(std::log(1.0 - success) / std::log(1.0 - inlier_ratio * inlier_ratio)));
}

std::vector<PlanarPair> inliers_of(std::span<const PlanarPair> pairs,
                                   const Rigid2& reference_from_query,
                                   double inlier_distance) {
  const Eigen::Matrix2f rotation =
      Eigen::Rotation2Dd(reference_from_query.angle).toRotationMatrix().cast<float>();
  const Eigen::Vector2f translation = reference_from_query.translation.cast<float>();
  const auto limit = static_cast<float>(inlier_distance * inlier_distance);
  std::vector<PlanarPair> inliers;
  for (const PlanarPair& pair : pairs) {
    const Eigen::Vector2f off = rotation * pair.query + translation - pair.reference;
    if (off.squaredNorm() < limit) inliers.push_back(pair);
  }
  return inliers;
}

}  // namespace

Eigen::Vector2d Rigid2::operator*(const Eigen::Vector2d& point) const {
  return Eigen::Rotation2Dd(angle) * point + translation;
}

Rigid3 Rigid2::in_space() const {
  Rigid3 transform;
  transform.rotation = Eigen::AngleAxisd(angle, Eigen::Vector3d::UnitZ());
  transform.translation << translation, 0.0;
  return transform;
}

Rigid2 fit_planar(std::span<const PlanarPair> pairs) {
  Eigen::Vector2d query_mean = Eigen::Vector2d::Zero();
  Eigen::Vector2d reference_mean = Eigen::Vector2d::Zero();
  for (const PlanarPair& pair : pairs) {
    query_mean += pair.query.cast<double>();
    reference_mean += pair.reference.cast<double>();
  }
  query_mean /= static_cast<double>(pairs.size());
  reference_mean /= static_cast<double>(pairs.size());
  double dot = 0.0;
  double cross = 0.0;
  for (const PlanarPair& pair : pairs) {
    const Eigen::Vector2d q = pair.query.cast<double>() - query_mean;
    const Eigen::Vector2d r = pair.reference.cast<double>() - reference_mean;
    dot += q.dot(r);
    cross += q.x() * r.y() - q.y() * r.x();
  }
  Rigid2 fit;
  fit.angle = std::atan2(cross, dot);
  fit.translation = reference_mean - Eigen::Rotation2Dd(fit.angle) * query_mean;
  return fit;
}

std::optional<PlanarAlignment> align_planar(std::span<const PlanarPair> pairs,
                                            double inlier_distance,
                                            std::uint64_t seed) {
  if (pairs.size() < 2) return std::nullopt;
  RandomBits random(seed);
  std::vector<PlanarPair> best;
  for (int trial = 0; trial < trials(); ++trial) {
    const PlanarPair& a = pairs[random.below(pairs.size())];
    const PlanarPair& b = pairs[random.below(pairs.size())];
    const double query_length = static_cast<double>((b.query - a.query).norm());
    const double reference_length = static_cast<double>((b.reference - a.reference).norm());
    if (std::abs(query_length - reference_length) > 2.0 * inlier_distance) continue;
    // A short base leaves the angle open.
    if (query_length < 2.0 * inlier_distance) continue;
    const PlanarPair two[] = {a, b};
    std::vector<PlanarPair> inliers = inliers_of(pairs, fit_planar(two), inlier_distance);
    if (inliers.size() > best.size()) best = std::move(inliers);
  }
  if (best.size() < 2) return std::nullopt;
  PlanarAlignment alignment{fit_planar(best), static_cast<int>(best.size())};
  for (int i = 0; i < refits; ++i) {
    std::vector<PlanarPair> inliers =
        inliers_of(pairs, alignment.reference_from_query, inlier_distance);
    if (inliers.size() <= best.size()) break;
    best = std::move(inliers);
    alignment = {fit_planar(best), static_cast<int>(best.size())};
  }
  return alignment;
}

}  // namespace kissmap
