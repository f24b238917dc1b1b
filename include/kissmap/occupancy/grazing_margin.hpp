// SPDX-License-Identifier: MIT
#pragma once

#include <Eigen/Core>
#include <vector>

#include "kissmap/occupancy/occupancy_map.hpp"
#include "kissmap/parallel/thread_pool.hpp"

namespace kissmap {

struct GrazingOptions {
  double min_margin = 0.0;      ///< m, >= 0; of every hit
  double surface_noise = 0.03;  ///< m, > 0; how far returns lie off their surface
};

/// How far before its end each ray has to stop carving so that it leaves the surface it ends on
/// alone: RayScan::margins for the rays of one scan (its own margins are not read).
///
/// A voxel that a plane of unit normal n cuts reaches at most e = |n_x| v_x + |n_y| v_y + |n_z| v_z
/// above it. A ray that meets the plane at the angle g therefore keeps out of all such voxels until
/// (e + noise) / sin(g) before its end: 13 m for a floor of 0.2 m voxels seen at 1 degree, and
/// nothing it carves belongs to the floor, while all space more than e above it is carved.
///
/// Planes come from the scan itself, by principal components of the ends of rays that are
/// neighbours in direction, not in space: returns from a floor seen at 1 degree lie 10 m apart, yet
/// are next to each other as the sensor sees them. Cells of 0.7 degrees, taken 3 x 3, and where
/// these see no plane or too few returns, cells twice, four and eight times as wide. Steps in depth
/// fail as planes because they leave a residual in proportion to the width of the cells.
/// A ray that ends less than e above a plane of its neighbours, as at the foot of a wall, keeps
/// clear of that plane too. Rays that are no hits keep clear of surfaces along which they pass, and
/// of floors (n_z > 0.7, z up) below which they would end, so that a puddle that swallows the beam
/// makes no hole. Rays that are to be bent: first the margins, then bend.
///
/// One margin a ray [m], 0 for rays that are not finite. The same for any number of threads.
/// Throws Error(usage) naming an option out of range. Working memory: 20 MB
/// and 100 bytes a ray.
std::vector<float> grazing_margins(const RayScan& scan,
                                   const Eigen::Vector3d& voxel_size,
                                   const GrazingOptions& options,
                                   ThreadPool& pool);

}  // namespace kissmap
