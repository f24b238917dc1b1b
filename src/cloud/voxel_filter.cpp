// SPDX-License-Identifier: MIT
#include "kissmap/cloud/voxel_filter.hpp"

#include <algorithm>
#include <bit>

namespace kissmap {
namespace {

constexpr unsigned fewest_bits = 10;

// The table's first size: a function of the cloud alone, as the order of the result hangs on it.
// Sweeps put some four points or more into a voxel.
unsigned first_bits(std::size_t points) {
  return std::max(fewest_bits, static_cast<unsigned>(std::bit_width(points / 2)));
}

}  // namespace

void VoxelFilter::apply(std::span<const Eigen::Vector3f> points,
                        double voxel_size,
                        std::vector<Eigen::Vector3f>& kept) {
  const auto per_metre = static_cast<float>(1.0 / voxel_size);
  bits_ = first_bits(points.size());
  table_.assign(std::size_t{1} << bits_, Entry{});
  used_ = 0;
  VoxelKey last = no_voxel;
  for (std::uint32_t i = 0; i < points.size(); ++i) {
    const VoxelKey key = voxel_key(voxel_of(points[i], per_metre));
    // Neighbours in a sweep mostly share their voxel, which saves the look-up.
    if (key != last) insert({key, i});
    last = key;
  }
  kept.clear();
  for (const Entry& entry : table_) {
    if (entry.key != no_voxel) kept.push_back(points[entry.point_idx]);
  }
}

void VoxelFilter::insert(const Entry& entry) {
  const std::size_t mask = table_.size() - 1;
  std::size_t i = voxel_hash(entry.key, bits_);
  while (table_[i].key != no_voxel) {
    if (table_[i].key == entry.key) return;
    i = (i + 1) & mask;
  }
  table_[i] = entry;
  if (2 * ++used_ > table_.size()) grow();
}

void VoxelFilter::grow() {
  ++bits_;
  table_.swap(old_table_);
  table_.assign(std::size_t{1} << bits_, Entry{});
  used_ = 0;
  for (const Entry& entry : old_table_) {
    if (entry.key != no_voxel) insert(entry);
  }
}

}  // namespace kissmap
