// SPDX-License-Identifier: MIT
#include "kissmap/loop_closing/closure_validation.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

#include "options.hpp"

namespace kissmap {
namespace {

constexpr float steep = 0.5F;             // |z| of the normal, 60 degrees from the level
constexpr float agreeing_normals = 0.8F;  // cosine
constexpr float fitting_share = 0.2F;     // of a voxel, distance to the plane
// How sure a closure can be at best: surfaces are sampled by voxels, and each local map is bent by
// the drift between its keypose and the place where the two meet.
constexpr double best_translation = 0.05;   // m
constexpr double best_rotation = 0.003;     // rad
constexpr double bend_translation = 0.004;  // m per m
constexpr double bend_rotation = 0.001;     // rad per square root of m

/// The query laid over the reference.
struct Overlay {
  double overlap = 0.0;
  double wall_agreement = 0.0;
  Eigen::Vector3d center_in_query = Eigen::Vector3d::Zero();
};

Overlay overlay(const SurfelCloud& query,
                const SurfelMap& reference,
                const Rigid3& reference_from_query) {
  const Eigen::Matrix3f rotation = reference_from_query.rotation.toRotationMatrix().cast<float>();
  const Eigen::Vector3f translation = reference_from_query.translation.cast<float>();
  const float reach = fitting_share * static_cast<float>(reference.voxel_size());
  std::size_t near = 0;
  std::size_t fitting = 0;
  std::size_t shared = 0;
  Overlay result;
  for (std::size_t i = 0; i < query.size(); ++i) {
    const Eigen::Vector3f mean = rotation * query.means[i] + translation;
    if (reference.occupied(mean)) {
      ++shared;
      result.center_in_query += query.means[i].cast<double>();
    }
    const Eigen::Vector3f normal = rotation * query.normals[i];
    if (std::abs(normal.z()) > steep) continue;
    const std::int32_t nearest = reference.nearest(mean).surfel;
    if (nearest < 0) continue;
    ++near;
    const auto match = static_cast<std::size_t>(nearest);
    const Eigen::Vector3f& plane = reference.surfels().normals[match];
    const float off = std::abs(plane.dot(mean - reference.surfels().means[match]));
    if (off < reach && std::abs(plane.dot(normal)) > agreeing_normals) ++fitting;
  }
  if (shared > 0) result.center_in_query /= static_cast<double>(shared);
  if (near > 0) result.wall_agreement = static_cast<double>(fitting) / static_cast<double>(near);
  result.overlap = overlap(query, reference, reference_from_query);
  return result;
}

/// Smallest eigenvalue of the translation's share of the information, for one pair.
double observability(const SurfelAlignment& alignment) {
  if (alignment.pairs == 0) return 0.0;
  const Eigen::Matrix3d translation = alignment.hessian.topLeftCorner<3, 3>();
  const Eigen::Vector3d values =
      Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(translation).eigenvalues();
  return values.sum() > 0.0 ? values(0) / values.sum() : 0.0;
}

/// A rotation about a point away from the origin moves the origin: carries the information of
/// independent errors at `center` to the origin of the same frame.
Information information_at_keypose(const Twist& sigmas, const Eigen::Vector3d& center) {
  // exp(twist at center): vc = v0 - center x w.
  Eigen::Matrix<double, 6, 6> carry = Eigen::Matrix<double, 6, 6>::Identity();
  carry.topRightCorner<3, 3>() << 0, center.z(), -center.y(),  //
      -center.z(), 0, center.x(),                              //
      center.y(), -center.x(), 0;
  const Information information =
      carry.transpose() * sigmas.cwiseAbs2().cwiseInverse().asDiagonal() * carry;
  return 0.5 * (information + information.transpose());
}

}  // namespace

const char* to_string(ClosureSource source) {
  switch (source) {
    case ClosureSource::appearance:
      return "appearance";
    case ClosureSource::trajectory:
      return "trajectory";
    case ClosureSource::hand:
      return "hand";
  }
  return "unknown";
}

const char* to_string(ClosureVerdict verdict) {
  switch (verdict) {
    case ClosureVerdict::accepted:
      return "accepted";
    case ClosureVerdict::no_convergence:
      return "registration did not converge";
    case ClosureVerdict::low_overlap:
      return "overlap too low";
    case ClosureVerdict::walls_disagree:
      return "steep surfaces disagree";
    case ClosureVerdict::unobservable:
      return "a direction is left open";
    case ClosureVerdict::beyond_drift:
      return "further off than odometry drifts";
    case ClosureVerdict::refused_by_graph:
      return "contradicts other closures";
    case ClosureVerdict::removed_by_hand:
      return "removed by hand";
  }
  return "unknown";
}

std::string reason(const Closure& closure) {
  if (closure.verdict != ClosureVerdict::accepted) return to_string(closure.verdict);
  if (closure.source == ClosureSource::hand) return "added by hand";
  if (!closure.trusted) return to_string(closure.verdict);
  std::string text = "fixed by hand";
  if (closure.first_verdict == ClosureVerdict::accepted) return text;
  return text.append("; ").append(to_string(closure.first_verdict));
}

bool enters_graph(const Closure& closure) {
  if (closure.verdict == ClosureVerdict::removed_by_hand) return false;
  return closure.trusted || closure.first_verdict == ClosureVerdict::accepted;
}

void require_valid(const ClosureValidationOptions& options) {
  require_between("min_overlap", options.min_overlap, 0.0, 1.0);
  require_between("min_wall_agreement", options.min_wall_agreement, 0.0, 1.0);
  require_between("min_observability", options.min_observability, 0.0, 0.33);
}

Information information_of(const Closure& closure) {
  Twist sigmas;
  if (closure.sigmas) {
    sigmas << Eigen::Vector3d::Constant(closure.sigmas->metres),
        Eigen::Vector3d::Constant(closure.sigmas->radians);
    return information_at_keypose(sigmas, closure.center_in_query);
  }
  const double arms = closure.center_in_query.norm() +
                      (closure.reference_from_query * closure.center_in_query).norm();
  sigmas.head<3>().setConstant(std::hypot(best_translation, bend_translation * arms));
  sigmas.tail<3>().setConstant(std::hypot(best_rotation, bend_rotation * std::sqrt(arms)));
  return information_at_keypose(sigmas, closure.center_in_query);
}

namespace {

/// Fills in what a pose alone decides.
void lay_over(const SurfelCloud& query, const SurfelReference& reference, Closure& closure) {
  const Overlay laid = overlay(query, reference.fine(), closure.reference_from_query);
  closure.overlap = laid.overlap;
  closure.wall_agreement = laid.wall_agreement;
  closure.center_in_query = laid.center_in_query;
  closure.information = information_of(closure);
}

}  // namespace

Closure validate_closure(const SurfelCloud& query,
                         const SurfelReference& reference,
                         const Rigid3& guess_reference_from_query,
                         const ClosureValidationOptions& options) {
  const SurfelAlignment alignment = register_surfels(query, reference, guess_reference_from_query);
  Closure closure;
  closure.iterations = alignment.iterations;
  closure.residual_before = alignment.residual_before;
  closure.residual_after = alignment.residual_after;
  closure.reference_from_query = alignment.reference_from_query;
  lay_over(query, reference, closure);
  if (!alignment.converged) {
    // Along an open direction a registration may slide for ever.
    closure.verdict = alignment.pairs > 0 && observability(alignment) < options.min_observability
                          ? ClosureVerdict::unobservable
                          : ClosureVerdict::no_convergence;
    return closure;
  }
  if (closure.overlap < options.min_overlap) {
    closure.verdict = ClosureVerdict::low_overlap;
  } else if (observability(alignment) < options.min_observability) {
    closure.verdict = ClosureVerdict::unobservable;
  } else if (closure.wall_agreement < options.min_wall_agreement) {
    closure.verdict = ClosureVerdict::walls_disagree;
  }
  return closure;
}

Closure measure_closure(const SurfelCloud& query,
                        const SurfelReference& reference,
                        const Rigid3& reference_from_query) {
  Closure closure;
  const double residual = register_surfels(query, reference, reference_from_query).residual_before;
  closure.residual_before = residual;
  closure.residual_after = residual;
  closure.reference_from_query = reference_from_query;
  lay_over(query, reference, closure);
  return closure;
}

}  // namespace kissmap
