// SPDX-License-Identifier: MIT
#pragma once

#include "kissmap/grid/grid_map.hpp"
#include "kissmap/occupancy/occupancy_map.hpp"

namespace kissmap {

/// The 2D map of a voxel map that is limited to layers, all of which are the band: each column
/// judged by the rule. Covers the columns of all blocks with a known voxel, empty if there are
/// none. Voxels must be square in the plane and their origin at zero there.
GridMap project_columns(const OccupancyMap& voxels, const ColumnRule& rule);

}  // namespace kissmap
