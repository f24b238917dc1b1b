// SPDX-License-Identifier: MIT
#pragma once

#include "kissmap/loop_closing/closure.hpp"
#include "kissmap/loop_closing/surfel_registration.hpp"

namespace kissmap {

/// What a registration must show to be believed.
struct ClosureValidationOptions {
  double min_overlap = 0.4;
  double min_wall_agreement = 0.6;
  /// Smallest eigenvalue of the translation's information per pair; 1/3 is equal in all directions.
  double min_observability = 0.01;
};
/// Throws Error(usage) naming the field, its value and its range.
void require_valid(const ClosureValidationOptions& options);

/// Of reference_from_query in the query's frame: from the sigmas, or else from the lever arms to
/// where the two meet. Pure; a function of the pose, the center and the sigmas only.
Information information_of(const Closure& closure);

/// Registers the query to the reference from a guess and judges the outcome on geometry alone:
/// convergence, overlap, observability, agreement of steep surfaces, in this order. Fills all of
/// the closure but ids, source, inliers and sigmas. Pure.
///
/// Overlap alone is no proof: floors and ceilings share voxels wherever two rooms are laid over
/// each other. Steep surfaces (walls, poles, trees) do so only at the true place.
Closure validate_closure(const SurfelCloud& query,
                         const SurfelReference& reference,
                         const Rigid3& guess_reference_from_query,
                         const ClosureValidationOptions& options);

/// The same figures for a pose that is taken as it is: nothing is registered or refused, and the
/// residual before and after is that of the pose.
Closure measure_closure(const SurfelCloud& query,
                        const SurfelReference& reference,
                        const Rigid3& reference_from_query);

}  // namespace kissmap
