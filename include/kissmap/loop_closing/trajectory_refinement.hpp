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

struct RefinedTrajectory {
  std::vector<Rigid3> map_from_lidar;      ///< one a scan
  std::vector<Rigid3> map_from_local_map;  ///< by id: the local map as a rigid body, placed where
                                           ///< its middle scan is
};

/// One graph over all scans: the motions the odometry found, the closures, and the registrations of
/// each local map to the one before. Where METHOD section 4 holds the keyposes and spreads what is
/// left, this lets all scans move: a closure ties the scans nearest to the place where the two
/// local maps meet, not keyposes that may be tens of metres from it, and a local map that drift has
/// bent is straightened.
///
/// Why neighbours: the odometry matches points to points. Rings of a spinning sensor slide over
/// walls as it moves, and pull it upwards on the walls ahead: it pitches by some hundredths of a
/// degree a metre. Registering surfaces to planes does not, and what was seen from a stretch much
/// shorter than the view is not bent itself.
///
/// Surface links, if there are any, have the last word: a second graph holds them, too, and may
/// refuse what contradicts them, but for closures that are trusted.
///
/// `scans` as for spread_corrections(). Closures must be accepted ones. The first scan stays where
/// it is. Takes time proportional to the number of scans. One
/// thread, the same result on every run. Throws Error(input) for ids that are out of range.
RefinedTrajectory refine_trajectory(std::span<const ScanPlace> scans,
                                    const std::vector<Rigid3>& map_from_local_map,
                                    std::span<const Closure> closures,
                                    std::span<const NeighborLink> neighbors,
                                    std::span<const SurfaceLink> surfaces = {});

}  // namespace kissmap
