// SPDX-License-Identifier: MIT
#pragma once

#include "grid/swept_cells.hpp"
#include "kissmap/grid/grid_map.hpp"
#include "kissmap/occupancy/occupancy_map.hpp"

namespace kissmap {

/// The 2D map of a voxel map that is limited to layers, all of which are the band: each column
/// judged by the rule. Covers the columns of all blocks with a known voxel, empty if there are
/// none. Voxels must be square in the plane and their origin at zero there. What is occupied where
/// the carrier went (in layers whose middle lies below its sensor) counts as free.
/// `area` [m]: only the blocks that reach into it.
GridMap project_columns(const OccupancyMap& voxels,
                        const ColumnRule& rule,
                        const SweptCells& swept,
                        const Eigen::AlignedBox2d& area);

/// The same of a map of which nothing is known but the voxels.
inline GridMap project_columns(const OccupancyMap& voxels, const ColumnRule& rule) {
  return project_columns(voxels, rule, SweptCells(1.0), everywhere());
}

}  // namespace kissmap
