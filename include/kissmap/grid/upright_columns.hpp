// SPDX-License-Identifier: MIT
#pragma once

#include <Eigen/Core>
#include <unordered_set>

#include "kissmap/cloud/voxel.hpp"
#include "kissmap/geometry/rigid3.hpp"
#include "kissmap/mapping/placed_scan.hpp"

namespace kissmap {

/// Where returns lie upon each other, 0.5 to 2 m apart in height, as on walls, trunks and cars. A
/// floor is not like that, however steep: where nobody knows how high it lies, this tells what
/// stands on it from the floor itself. Memory grows with the surfaces seen, by half metres. Not
/// thread safe.
class UprightColumns {
 public:
  void add(const PlacedScan& scan, const Rigid3& level_from_map);

  /// Whether something was seen above or below a return [m, level frame].
  bool holds(const Eigen::Vector3d& hit) const;

 private:
  std::unordered_set<VoxelKey> seen_;
};

}  // namespace kissmap
