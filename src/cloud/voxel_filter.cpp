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
  Entry* entry = nullptr;
  for (std::uint32_t i = 0; i < points.size(); ++i) {
    const Voxel voxel = voxel_of(points[i], per_metre);
    const VoxelKey key = voxel_key(voxel);
    const Eigen::Vector3f center =
        Eigen::Vector3f(
            static_cast<float>(voxel.x), static_cast<float>(voxel.y), static_cast<float>(voxel.z))
            .array() +
        0.5F;
    const float squared_distance = (points[i] * per_metre - center).squaredNorm();
    // Neighbours in a sweep mostly share their voxel, which saves the look-up.
    if (entry == nullptr || entry->key != key) entry = &slot_of(key);
    if (entry->key == no_voxel) {
      *entry = {key, i, squared_distance};
      if (2 * ++used_ > table_.size()) {
        grow();
        entry = nullptr;
      }
    } else if (squared_distance < entry->squared_distance) {
      entry->point_idx = i;
      entry->squared_distance = squared_distance;
    }
  }
  kept.clear();
  for (const Entry& e : table_) {
    if (e.key != no_voxel) kept.push_back(points[e.point_idx]);
  }
}

VoxelFilter::Entry& VoxelFilter::slot_of(VoxelKey key) {
  const std::size_t mask = table_.size() - 1;
  std::size_t i = voxel_hash(key, bits_);
  while (table_[i].key != key && table_[i].key != no_voxel) i = (i + 1) & mask;
  return table_[i];
}

void VoxelFilter::grow() {
  ++bits_;
  table_.swap(old_table_);
  table_.assign(std::size_t{1} << bits_, Entry{});
  for (const Entry& entry : old_table_) {
    if (entry.key != no_voxel) slot_of(entry.key) = entry;
  }
}

}  // namespace kissmap
