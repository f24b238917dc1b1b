// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "kissmap/geometry/rigid3.hpp"
#include "kissmap/graph/pose_graph.hpp"
#include "kissmap/loop_closing/stretch.hpp"
#include "kissmap/loop_closing/surface_link.hpp"
#include "kissmap/parallel/thread_pool.hpp"

namespace kissmap {

/// Where scans lie, given links between the surfaces around them: map_from_lidar of each.
using TrajectoryByLinks = std::function<std::vector<Rigid3>(std::span<const SurfaceLink>)>;

/// Registers stretches to the ones around them, whether they came just before or belong to an
/// earlier visit: each to the one before it, and to up to six others within a mean range, the
/// nearest first (if the one before is not among these), by the middle of what they show.
///
/// Point-to-plane over many overlapping pieces is what leaves no double walls: odometry fits
/// points to points scan by scan, and a closure ties two places of a tour, while drift bends what
/// lies between them. It also ties visits which share too little for a closure, as those of a
/// narrow view that comes back along a street.
///
/// Poses have to be good to about two voxels of a stretch where two are to be linked. `trajectory`
/// is asked without links for the first ones, and again with all that were found: where that moved
/// stretches, they are looked at again, until hardly anything changes or for five rounds. Returned
/// are the links it was asked with last.
///
/// `surfels(i)` gives back the surfels of stretch i; it is called several times for each, from
/// several threads at once. `scan_links` are those of all stretches, which become part of the
/// result. Links ascend by reference, then by query. The same result for any number of threads.
std::vector<SurfaceLink> link_surfaces(std::span<const StretchPlace> stretches,
                                       const std::function<SurfelCloud(std::size_t)>& surfels,
                                       std::span<const SurfaceLink> scan_links,
                                       const TrajectoryByLinks& trajectory,
                                       ThreadPool& pool);

/// One graph over all scans: the motions between them in `graph` (nodes: scans, in the order of
/// time, edges: what is known of them), and the links that agree with where `graph` has its nodes
/// by now, to 1.5 m and 0.1 rad; then those that agree with where the first ones put them, until
/// these are the same. Links to other visits, and edges of kind closure, may be refused as false.
/// Returns map_from_lidar of every scan. Throws Error(input) for a link to a scan that is not
/// there.
std::vector<Rigid3> fit_surfaces(PoseGraph graph, std::span<const SurfaceLink> links);

}  // namespace kissmap
