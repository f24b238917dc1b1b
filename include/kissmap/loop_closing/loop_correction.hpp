// SPDX-License-Identifier: MIT
#pragma once

#include <span>
#include <vector>

#include "kissmap/geometry/rigid3.hpp"
#include "kissmap/graph/pose_graph.hpp"
#include "kissmap/graph/trajectory_spread.hpp"
#include "kissmap/loop_closing/closure.hpp"
#include "kissmap/loop_closing/surface_links.hpp"

namespace kissmap {

/// All that was measured of loops. With the places of the scans, the corrected poses follow from
/// it and from nothing else.
struct LoopEvidence {
  std::vector<Rigid3> map_from_local_map;  ///< keyposes by odometry, by id
  std::vector<double> path_lengths;        ///< m, of each local map
  std::vector<Closure> closures;           ///< all candidates
  std::vector<NeighborLink> neighbors;
  std::vector<SurfaceLink> surfaces;
};

/// What closing loops makes of a map.
struct LoopCorrection {
  std::vector<Rigid3> map_from_local_map;  ///< keyposes by id: local maps as rigid bodies
  std::vector<Rigid3> map_from_lidar;      ///< one a scan
  std::vector<Closure> closures;           ///< those of the evidence, with their last verdicts
  std::vector<NeighborLink> neighbors;     ///< those of the evidence
  std::vector<SurfaceLink> surfaces;       ///< those of the evidence
  PoseGraph graph;                         ///< of the keyposes, at its optimum
  std::vector<double> edge_weights;        ///< of the graph: 1 believed, 0 refused
};

/// Information of an odometry edge over a path of `length` [m]: a random walk of 3 cm and 3 mrad
/// for the first metre.
Information odometry_information(double length);

/// Keyposes by odometry, an edge from each to the next, then one for each closure that
/// enters_graph(), in their order. Trusted closures are edges the optimisation does not doubt.
PoseGraph keypose_graph(std::span<const Rigid3> map_from_local_map,
                        std::span<const double> path_lengths,
                        std::span<const Closure> closures);

/// Verdicts of the closures in keypose_graph(), from what its optimisation made of their edges.
void set_verdicts(std::span<const double> edge_weights, std::vector<Closure>& closures);

/// From what was measured to the corrected trajectory, starting at the odometry: the keypose graph
/// says which closures to believe, then refine_trajectory() moves all scans, by surfaces if they
/// were linked; not by those between two local maps whose closure was removed by hand. The history
/// of a run does not matter, so that the same evidence gives the same result when it is read back.
/// `scans` as for spread_corrections(). One thread, the same result on every run. Thread safe.
/// Throws Error(input) for ids out of range.
LoopCorrection correct_loops(std::span<const ScanPlace> scans, const LoopEvidence& evidence);

}  // namespace kissmap
