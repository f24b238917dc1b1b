// SPDX-License-Identifier: MIT
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <vector>

#include "kissmap/cloud/voxel.hpp"

namespace kissmap {

/// Thins a cloud to one original point a voxel, the first in the order given.
///
/// Kept points come in the order of their voxels' hashes, so that neighbours in space are strewn
/// over the result. It matters: a second, coarser thinning of points in recorded order would keep
/// those on the side from which the sensor sweeps, a bias that has lost whole logs.
/// The result depends on the points alone. The table is kept between calls, so that clouds of
/// similar size need no allocation. Not thread safe.
class VoxelFilter {
 public:
  /// `voxel_size` > 0 [m]. Writes the kept points to `kept`, which must not be `points`.
  void apply(std::span<const Eigen::Vector3f> points,
             double voxel_size,
             std::vector<Eigen::Vector3f>& kept);

 private:
  struct Entry {
    VoxelKey key = no_voxel;
    std::uint32_t point_idx = 0;
  };

  void insert(const Entry& entry, std::size_t home);

  std::vector<Entry> table_;  ///< open addressing, linear probing, at most half full
};

}  // namespace kissmap
