// SPDX-License-Identifier: MIT
#include "kissmap/grid/upright_columns.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "thinning.hpp"

namespace kissmap {
namespace {

constexpr double side = 0.5;  // m of a voxel
// Two voxels off means 0.5 m or more between returns, three 2 m at most.
constexpr std::array<std::int32_t, 4> apart = {-3, -2, 2, 3};
constexpr std::size_t enough_points = 16384;  // of a scan

Voxel place_of(const Eigen::Vector3d& point) {
  const auto cell = [](double v) { return static_cast<std::int32_t>(std::floor(v / side)); };
  return {cell(point.x()), cell(point.y()), cell(point.z())};
}

}  // namespace

void UprightColumns::add(const PlacedScan& scan, const Rigid3& level_from_map) {
  const Rigid3 level_from_lidar = level_from_map * scan.map_from_lidar;
  VoxelKey last = no_voxel;
  Thinning(scan.points.size(), enough_points).for_each([&](std::size_t i) {
    const VoxelKey key = voxel_key(place_of(level_from_lidar * scan.points[i].cast<double>()));
    if (key != last) seen_.insert(key);
    last = key;
  });
}

bool UprightColumns::holds(const Eigen::Vector3d& hit) const {
  const Voxel place = place_of(hit);
  return std::ranges::any_of(apart, [&](std::int32_t up) {
    return seen_.contains(voxel_key({place.x, place.y, place.z + up}));
  });
}

}  // namespace kissmap
