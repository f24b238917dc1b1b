// SPDX-License-Identifier: MIT
#include "kissmap/cloud/voxel_filter.hpp"

#include <algorithm>
#include <array>
#include <bit>

namespace kissmap {
namespace {

constexpr std::size_t batch = 32;  // points whose places in the table are on their way at a time

// The order of the kept points. Spatial hash of Teschner et al., "Optimized Spatial Hashing for
// Collision Detection of Deformable Objects" (2003), with the second factor of the published
// odometry. Hashes that are linear in the voxel favour the same side of every larger voxel, which
// moved the error of narrow-view logs by a fifth up or a third down; this one does not.
std::size_t order_hash(const Voxel& voxel) {
  return static_cast<std::uint32_t>(voxel.x) * 73856093U ^
         static_cast<std::uint32_t>(voxel.y) * 19349669U ^
         static_cast<std::uint32_t>(voxel.z) * 83492791U;
}

}  // namespace

void VoxelFilter::apply(std::span<const Eigen::Vector3f> points,
                        double voxel_size,
                        std::vector<Eigen::Vector3f>& kept) {
  const auto per_metre = static_cast<float>(1.0 / voxel_size);
  // At most half full, and a function of the cloud alone, as the order of the result hangs on it.
  table_.assign(std::bit_ceil(std::max<std::size_t>(1, 2 * points.size())), Entry{});
  const std::size_t mask = table_.size() - 1;
  VoxelKey last = no_voxel;
  std::array<Entry, batch> entries;
  std::array<std::size_t, batch> homes;
  for (std::size_t begin = 0; begin < points.size(); begin += batch) {
    const std::size_t end = std::min(points.size(), begin + batch);
    std::size_t count = 0;
    for (std::size_t i = begin; i < end; ++i) {
      const Voxel voxel = voxel_of(points[i], per_metre);
      const VoxelKey key = voxel_key(voxel);
      // Neighbours in a sweep mostly share their voxel, which saves the look-up.
      if (key == last) continue;
      last = key;
      entries[count] = {key, static_cast<std::uint32_t>(i)};
      homes[count] = order_hash(voxel) & mask;
      __builtin_prefetch(&table_[homes[count++]], 1);
    }
    for (std::size_t i = 0; i < count; ++i) insert(entries[i], homes[i]);
  }
  kept.clear();
  for (const Entry& entry : table_) {
    if (entry.key != no_voxel) kept.push_back(points[entry.point_idx]);
  }
}

void VoxelFilter::insert(const Entry& entry, std::size_t home) {
  const std::size_t mask = table_.size() - 1;
  std::size_t i = home;
  while (table_[i].key != no_voxel) {
    if (table_[i].key == entry.key) return;
    i = (i + 1) & mask;
  }
  table_[i] = entry;
}

}  // namespace kissmap
