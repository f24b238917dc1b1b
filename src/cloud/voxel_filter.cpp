// SPDX-License-Identifier: MIT
#include "kissmap/cloud/voxel_filter.hpp"

#include <algorithm>

namespace kissmap {
namespace {

constexpr unsigned initial_bits = 14;

}  // namespace

void VoxelFilter::apply(std::span<const Eigen::Vector3f> points,
                        double voxel_size,
                        std::vector<Eigen::Vector3f>& kept) {
  const auto per_metre = static_cast<float>(1.0 / voxel_size);
  if (bits_ == 0) {
    bits_ = initial_bits;
    table_.resize(std::size_t{1} << bits_);
  }
  std::ranges::fill(table_, no_voxel);
  used_ = 0;
  kept.clear();
  VoxelKey last = no_voxel;
  for (const Eigen::Vector3f& point : points) {
    const VoxelKey key = voxel_key(voxel_of(point, per_metre));
    // Neighbours in a sweep mostly share their voxel; this saves the look-up.
    if (key == last) continue;
    last = key;
    if (insert(key)) kept.push_back(point);
  }
}

bool VoxelFilter::insert(VoxelKey key) {
  const std::size_t mask = table_.size() - 1;
  std::size_t i = voxel_hash(key, bits_);
  while (table_[i] != no_voxel) {
    if (table_[i] == key) return false;
    i = (i + 1) & mask;
  }
  table_[i] = key;
  if (2 * ++used_ > table_.size()) grow();
  return true;
}

void VoxelFilter::grow() {
  const std::vector<VoxelKey> old = std::move(table_);
  ++bits_;
  table_.assign(std::size_t{1} << bits_, no_voxel);
  used_ = 0;
  for (const VoxelKey key : old) {
    if (key != no_voxel) insert(key);
  }
}

}  // namespace kissmap
