// SPDX-License-Identifier: MIT
#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "kissmap/cloud/voxel.hpp"

namespace kissmap {

/// Thins a cloud to one original point a voxel: the first in the order given, so the result is a
/// subsequence of the input and depends on nothing else. Keeps its table between calls, so that
/// clouds of similar size need no allocation. Not thread safe.
class VoxelFilter {
 public:
  /// `voxel_size` > 0 [m]. Writes the kept points to `kept` (its old content is dropped).
  void apply(std::span<const Eigen::Vector3f> points,
             double voxel_size,
             std::vector<Eigen::Vector3f>& kept);

 private:
  bool insert(VoxelKey key);
  void grow();

  std::vector<VoxelKey> table_;  ///< open addressing, linear probing, at most half full
  std::size_t used_ = 0;
  unsigned bits_ = 0;
};

}  // namespace kissmap
