// SPDX-License-Identifier: MIT
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <deque>
#include <vector>

#include "kissmap/cloud/map_point.hpp"
#include "kissmap/cloud/voxel.hpp"
#include "kissmap/parallel/thread_pool.hpp"

namespace kissmap {

/// A map thinned to one real point a voxel while the points come: a point takes the place of the
/// one kept if it is nearer to the mean of all points its voxel has seen so far, itself included
/// (of two, the first stays).
/// So nothing is invented, and yet noise shrinks as a voxel is seen again.
/// Depends on the points and their order alone. Memory: about 110 bytes a voxel, whatever the
/// number of points. Not thread safe.
class ThinnedCloud {
 public:
  /// `voxel_size` > 0 [m]; voxel (i,j,k) covers [i v, (i+1) v) x ... of the map frame.
  explicit ThinnedCloud(double voxel_size);

  /// Throws Error(usage) where the voxels are too small to be counted: 2^20 of them from the origin
  /// of the map in any direction.
  void add(const MapPoint& point);

  std::size_t size() const { return cells_.size(); }
  std::uint64_t points_added() const { return points_added_; }

  /// The point kept in voxel i; voxels in the order in which they were first seen.
  const MapPoint& operator[](std::size_t i) const { return cells_[i].point; }

  /// For each of the points kept, the direction in which the means of the 5 x 5 x 5 voxels about it
  /// vary least (PCA), towards the sensor that saw the point. NaN where fewer than five voxels are
  /// seen, or where they are on one line. The same for any number of threads.
  std::vector<Eigen::Vector3f> normals(ThreadPool& pool) const;

 private:
  struct Cell {
    VoxelKey key = no_voxel;
    std::uint32_t count = 0;
    Eigen::Vector3f mean = Eigen::Vector3f::Zero();  ///< m, from the lower corner of the voxel
    MapPoint point;
  };

  /// 4 x 4 x 4 voxels, so that neighbours in space are neighbours in memory.
  struct Block {
    VoxelKey key = no_voxel;
    std::array<std::uint32_t, 64> cells{};  ///< index of a cell plus one; 0: not seen
  };

  Voxel voxel_at(const Eigen::Vector3d& position) const;
  Eigen::Vector3f in_voxel(const Eigen::Vector3d& position, const Voxel& voxel) const;
  Cell& cell_at(const Voxel& voxel);
  const Block* find_block(const Voxel& block) const;
  Block& block_at(const Voxel& block);
  std::size_t slot_of(VoxelKey key) const;
  void grow();
  Eigen::Vector3f normal_at(const Cell& cell) const;

  double voxel_size_;
  std::uint64_t points_added_ = 0;
  std::deque<Cell> cells_;
  std::deque<Block> blocks_;
  std::vector<std::uint32_t> table_;  ///< index of a block plus one; 0: free. At most half full
};

}  // namespace kissmap
