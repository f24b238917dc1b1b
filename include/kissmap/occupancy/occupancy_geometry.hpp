// SPDX-License-Identifier: MIT
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>

#include "kissmap/cloud/voxel.hpp"

namespace kissmap {

/// Layers of voxels, both ends included: z of Voxel.
struct LayerRange {
  std::int32_t first = 0;
  std::int32_t last = 0;
  friend bool operator==(const LayerRange&, const LayerRange&) = default;
};

/// Where the voxels of an occupancy map lie. Voxel (i,j,k) covers the box from
/// origin + (i,j,k) * voxel_size to origin + (i+1,j+1,k+1) * voxel_size, lower faces included.
/// The frame is the caller's: `map`, or one whose z is the height above the floor, where `origin`
/// and the height of a voxel can put faces exactly on the edges of a band of heights.
struct OccupancyGeometry {
  Eigen::Vector3d origin = Eigen::Vector3d::Zero();             ///< m
  Eigen::Vector3d voxel_size = Eigen::Vector3d::Constant(0.2);  ///< m, each within 1e-3..1e3
  std::optional<LayerRange> layers;  ///< others are neither stored nor visited; none: no limit

  friend bool operator==(const OccupancyGeometry&, const OccupancyGeometry&) = default;
};

/// Voxels whose indices are all smaller than this in magnitude can be mapped: 1600 km at 5 cm.
inline constexpr std::int32_t max_voxel_index = 1 << 25;

/// Throws Error(usage) naming the field.
void require_valid(const OccupancyGeometry& geometry);

/// The voxel of a point [m]; none if the point is not finite or farther than max_voxel_index.
/// Layers are not looked at.
std::optional<Voxel> voxel_at(const OccupancyGeometry& geometry, const Eigen::Vector3d& point);

/// Centre of a voxel [m].
Eigen::Vector3d voxel_center(const OccupancyGeometry& geometry, const Voxel& voxel);

}  // namespace kissmap
