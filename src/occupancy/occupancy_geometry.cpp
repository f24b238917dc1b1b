// SPDX-License-Identifier: MIT
#include "kissmap/occupancy/occupancy_geometry.hpp"

#include <cmath>

#include "kissmap/error.hpp"
#include "options.hpp"

namespace kissmap {

void require_valid(const OccupancyGeometry& geometry) {
  for (int axis = 0; axis < 3; ++axis) {
    require_between("voxel_size", geometry.voxel_size[axis], 1e-3, 1e3);
    require_between("origin", geometry.origin[axis], -1e9, 1e9);
  }
  if (!geometry.layers) return;
  const auto [first, last] = *geometry.layers;
  require_between("layers.first", first, -max_voxel_index + 1, max_voxel_index - 1);
  require_between("layers.last", last, first, max_voxel_index - 1);
}

std::optional<Voxel> voxel_at(const OccupancyGeometry& geometry, const Eigen::Vector3d& point) {
  const Eigen::Array3d index =
      ((point - geometry.origin).array() / geometry.voxel_size.array()).floor();
  if (!(index.abs() < static_cast<double>(max_voxel_index)).all()) return std::nullopt;
  return Voxel{static_cast<std::int32_t>(index.x()),
               static_cast<std::int32_t>(index.y()),
               static_cast<std::int32_t>(index.z())};
}

Eigen::Vector3d voxel_center(const OccupancyGeometry& geometry, const Voxel& voxel) {
  const Eigen::Vector3d index(voxel.x + 0.5, voxel.y + 0.5, voxel.z + 0.5);
  return geometry.origin + index.cwiseProduct(geometry.voxel_size);
}

}  // namespace kissmap
