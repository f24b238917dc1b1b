// SPDX-License-Identifier: MIT
#include "kissmap/loop_closing/map_outline.hpp"

#include <algorithm>

namespace kissmap {

MapOutline::MapOutline(const SurfelCloud& surfels, double voxel_size)
    : per_metre_(static_cast<float>(1.0 / voxel_size)) {
  std::vector<std::pair<VoxelKey, std::size_t>> places;
  places.reserve(surfels.size());
  for (std::size_t i = 0; i < surfels.size(); ++i) {
    places.emplace_back(voxel_key(voxel_of(surfels.means[i], per_metre_)), i);
    reach_ = std::max(reach_, surfels.means[i].norm());
  }
  std::ranges::sort(places);
  for (const auto& [key, i] : places) {
    if (!voxels_.empty() && voxels_.back() == key) continue;
    voxels_.push_back(key);
    means_.push_back(surfels.means[i]);
  }
}

double MapOutline::overlap(const MapOutline& other, const Rigid3& other_from_this) const {
  const auto apart = static_cast<float>(other_from_this.translation.norm());
  const std::size_t smaller = std::min(voxels_.size(), other.voxels_.size());
  if (smaller == 0 || apart > reach_ + other.reach_) return 0.0;
  const Eigen::Matrix4f transform = other_from_this.matrix().cast<float>();
  std::size_t shared = 0;
  for (const Eigen::Vector3f& mean : means_) {
    const Eigen::Vector3f moved =
        transform.topLeftCorner<3, 3>() * mean + transform.topRightCorner<3, 1>();
    const VoxelKey key = voxel_key(voxel_of(moved, per_metre_));
    if (std::ranges::binary_search(other.voxels_, key)) ++shared;
  }
  return std::min(1.0, static_cast<double>(shared) / static_cast<double>(smaller));
}

}  // namespace kissmap
