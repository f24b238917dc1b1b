// SPDX-License-Identifier: MIT
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <limits>
#include <memory>
#include <span>
#include <vector>

#include "kissmap/cloud/voxel.hpp"
#include "kissmap/geometry/rigid3.hpp"

namespace kissmap {

/// Points in a voxel grid, with nearest-neighbour search in the 27 voxels around a query
/// (METHOD section 1.6). The hot path of the odometry.
///
/// Memory layout. Two flat arrays:
///  - a hash table of 16-byte entries {64-bit voxel key, 32-bit block number, 32-bit point count},
///    open addressing with linear probing, a power of two long and at most half full; erasing
///    shifts later entries back, so there are no tombstones and look-ups never degrade;
///  - blocks of 256 bytes (four cache lines), one a voxel, in pages of 4096 that never move:
///    x[20], y[20], z[20] as floats, each padded with `far_away` beyond the points in use, so that
///    four distances are computed at a time without a mask. Freed blocks are reused, last first.
/// In the steady state (voxels leave as fast as they come) nothing is allocated.
///
/// Deterministic: the content depends only on the sequence of calls. Const members may be called
/// from several threads at once.
class VoxelHashMap {
 public:
  static constexpr int capacity = 20;  ///< points a voxel can hold

  /// voxel_size > 0 [m]; 1 <= max_points_per_voxel <= capacity.
  VoxelHashMap(double voxel_size, int max_points_per_voxel);

  /// Adds points [m] in order. A point is left out when its voxel is full or holds a point nearer
  /// than voxel_size / sqrt(max_points_per_voxel).
  void add(std::span<const Eigen::Vector3f> points);

  /// Drops every voxel whose centre is farther than `distance` [m] from `center`.
  void remove_farther_than(double distance, const Eigen::Vector3d& center);

  void clear();

  /// What a search found, and how sure it is.
  struct Neighbor {
    Eigen::Vector3f point = Eigen::Vector3f::Zero();
    bool found = false;
    float distance = std::numeric_limits<float>::infinity();  ///< m, to `point`
    /// No other point of the 27 voxels is nearer than this [m]; at least the search radius if
    /// there is none. While a query stays in its voxel and moves by less than half the difference
    /// to `distance`, its neighbour is the same.
    float next_distance = std::numeric_limits<float>::infinity();
  };

  /// The nearest point among the 27 voxels around the query's, nearer than max_distance [m].
  Neighbor nearest(const Eigen::Vector3f& query, float max_distance) const;

  /// All points, voxel by voxel in the order in which blocks were taken.
  std::vector<Eigen::Vector3f> points() const;

  /// Calls visit(span of points) for each voxel, in the same order.
  template <typename Visitor>
  void for_each_voxel(Visitor visit) const;

  bool empty() const { return voxel_count_ == 0; }
  std::size_t voxel_count() const { return voxel_count_; }
  double voxel_size() const { return voxel_size_; }
  float per_metre() const { return per_metre_; }
  std::size_t memory_bytes() const;

 private:
  static constexpr float far_away = 1e18F;
  static constexpr std::size_t blocks_per_page = 4096;

  struct alignas(64) Block {
    std::array<float, capacity> x;
    std::array<float, capacity> y;
    std::array<float, capacity> z;
    VoxelKey key;  ///< no_voxel while the block is free
    std::uint32_t count;
  };
  static_assert(sizeof(Block) == 256);

  struct Entry {
    VoxelKey key = no_voxel;
    std::uint32_t block = 0;
    std::uint32_t count = 0;
  };

  struct Search;
  const Entry* find(VoxelKey key) const;
  Entry& find_or_insert(VoxelKey key);  ///< Needs room in the table.
  void add(const Eigen::Vector3f& point, Entry& entry);
  static void prefetch(const Block& block);
  void erase(VoxelKey key);
  void grow();
  std::uint32_t take_block(VoxelKey key);
  Block& block(std::uint32_t number) {
    return pages_[number / blocks_per_page][number % blocks_per_page];
  }
  const Block& block(std::uint32_t number) const {
    return pages_[number / blocks_per_page][number % blocks_per_page];
  }

  double voxel_size_;
  float per_metre_;
  std::uint32_t max_points_;
  float min_spacing_squared_;
  std::vector<Entry> table_;
  unsigned bits_;
  std::vector<std::unique_ptr<Block[]>> pages_;
  std::uint32_t blocks_taken_ = 0;
  std::vector<std::uint32_t> free_blocks_;
  std::size_t voxel_count_ = 0;
};

template <typename Visitor>
void VoxelHashMap::for_each_voxel(Visitor visit) const {
  std::array<Eigen::Vector3f, capacity> points;
  for (std::uint32_t i = 0; i < blocks_taken_; ++i) {
    const Block& b = block(i);
    if (b.key == no_voxel) continue;
    for (std::uint32_t p = 0; p < b.count; ++p) points[p] = {b.x[p], b.y[p], b.z[p]};
    visit(std::span<const Eigen::Vector3f>(points.data(), b.count));
  }
}

}  // namespace kissmap
