// SPDX-License-Identifier: MIT
#pragma once

#include <Eigen/Core>
#include <vector>

#include "kissmap/cloud/voxel.hpp"
#include "kissmap/geometry/rigid3.hpp"
#include "kissmap/mapping/local_map.hpp"

namespace kissmap {

/// The rough shape of a local map, some kilobytes: enough to say whether two would overlap.
class MapOutline {
 public:
  /// `voxel_size` [m] should be well above the drift expected between neighbours in space.
  MapOutline(const SurfelCloud& surfels, double voxel_size);

  /// Share of this outline's voxels that fall into the other's, or of the other's if those are
  /// fewer, 0..1. Cheap where the two are far apart.
  double overlap(const MapOutline& other, const Rigid3& other_from_this) const;

 private:
  std::vector<Eigen::Vector3f> means_;  ///< one a voxel, m
  std::vector<VoxelKey> voxels_;        ///< sorted
  float per_metre_;
  float reach_ = 0.0F;  ///< m, farthest mean from the origin
};

}  // namespace kissmap
