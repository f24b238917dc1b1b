// SPDX-License-Identifier: MIT
#pragma once

#include "kissmap/mapping/local_map.hpp"
#include "kissmap/odometry/voxel_hash_map.hpp"

namespace kissmap {

/// Fewest points a voxel needs for a normal.
inline constexpr std::size_t min_points_per_surfel = 3;

/// Per voxel with at least min_points_per_surfel points: their mean, and the direction in which
/// they vary least (PCA), pointing towards the grid's origin. Voxels in the grid's own order.
SurfelCloud surfels_from_grid(const VoxelHashMap& grid);

}  // namespace kissmap
