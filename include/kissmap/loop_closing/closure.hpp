// SPDX-License-Identifier: MIT
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <string>

#include "kissmap/geometry/rigid3.hpp"
#include "kissmap/graph/pose_graph.hpp"

namespace kissmap {

/// Where the idea of a closure came from.
enum class ClosureSource : std::uint8_t {
  appearance,  ///< the places look alike from above
  trajectory,  ///< the corrected trajectory brings the local maps together
  hand         ///< somebody said so
};

/// What became of a candidate. Only `accepted` ones bend the map.
enum class ClosureVerdict : std::uint8_t {
  accepted,
  no_convergence,    ///< the registration did not come to rest
  low_overlap,       ///< too few voxels shared
  walls_disagree,    ///< steep surfaces near each other do not lie on each other
  unobservable,      ///< the shared surfaces leave a direction open, as in a bare corridor
  beyond_drift,      ///< further from the odometry than it can have drifted
  refused_by_graph,  ///< contradicts the other closures
  removed_by_hand
};
/// Short text for reports, the same for the same verdict.
const char* to_string(ClosureVerdict verdict);
const char* to_string(ClosureSource source);

/// Standard deviations of a closure where the two local maps meet: of each translation and of each
/// rotation.
struct ClosureSigmas {
  double metres = 0.0;
  double radians = 0.0;
};

/// A pair of local maps that may show one place, with all that was measured to judge it.
struct Closure {
  std::uint32_t query_id = 0;      ///< the later local map
  std::uint32_t reference_id = 0;  ///< the earlier one
  ClosureSource source = ClosureSource::appearance;
  ClosureVerdict verdict = ClosureVerdict::accepted;
  /// Before the graph and before edits by hand: what its own figures say.
  ClosureVerdict first_verdict = ClosureVerdict::accepted;
  bool trusted = false;          ///< fixed by hand: the graph may not refuse it
  int inliers = 0;               ///< feature matches that agree on the guess; 0 for `trajectory`
  int iterations = 0;            ///< of the registration
  double overlap = 0.0;          ///< Szymkiewicz-Simpson, 0..1
  double wall_agreement = 0.0;   ///< share of the query's steep surfels near the reference that fit
  double residual_before = 0.0;  ///< m, RMS to planes at the guess
  double residual_after = 0.0;   ///< m
  Rigid3 reference_from_query;   ///< between the keyposes
  Information information = Information::Zero();  ///< of it, in the query's frame
  /// Where the maps meet: mean of the query's surfels in shared voxels, query's frame [m].
  Eigen::Vector3d center_in_query = Eigen::Vector3d::Zero();
  std::optional<ClosureSigmas> sigmas;  ///< given by hand; without, they follow from the geometry
};

/// Why it has its verdict, for reports: the verdict's text, or what was done by hand.
std::string reason(const Closure& closure);

/// Whether the pose graph hears of it: its own figures or a hand support it, and no hand removed
/// it.
bool enters_graph(const Closure& closure);

/// Two local maps in a row, the openings of which were registered to each other.
struct NeighborLink {
  std::uint32_t reference_id = 0;    ///< the query is the next one
  Rigid3 reference_from_query;       ///< between the keyposes
  std::uint32_t reference_scan = 0;  ///< middle scan of the opening, counted in its local map
  std::uint32_t query_scan = 0;
  double extent = 0.0;  ///< m, root mean square distance of the query's surfels from their mean
};

}  // namespace kissmap
