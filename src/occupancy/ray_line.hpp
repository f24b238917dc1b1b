// SPDX-License-Identifier: MIT
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <optional>

#include "kissmap/occupancy/occupancy_geometry.hpp"

namespace kissmap::occupancy {

/// Positions along a ray in 2^-32 of a voxel, measured on the axis along which the ray is longest.
/// All stepping is done in these whole numbers, so that a ray cut at tiles crosses the same voxels
/// as in one piece.
using RayPosition = std::int64_t;

inline constexpr int position_bits = 32;
inline constexpr RayPosition never = std::int64_t{1} << 61;

/// Longest ray, in voxels along its longest axis.
inline constexpr double max_ray_voxels = 1 << 20;

/// The faces a ray crosses along one axis: number m = 0, 1, ... lies at first + m * spacing.
struct FaceCrossings {
  RayPosition first = never;
  RayPosition spacing = 0;
  double per_position = 0.0;  ///< 1 / spacing
  std::int32_t start = 0;     ///< voxel index before the first crossing
  std::int32_t step = 1;      ///< of the voxel index at each crossing: 1 or -1

  RayPosition at(std::int64_t m) const { return first == never ? never : first + m * spacing; }
  /// How many lie at or before a position.
  std::int64_t count_until(RayPosition position) const {
    if (position < first) return 0;
    auto m = static_cast<std::int64_t>(static_cast<double>(position - first) * per_position);
    while (first + m * spacing > position) --m;
    while (first + (m + 1) * spacing <= position) ++m;
    return m + 1;
  }
  std::int32_t index_after(std::int64_t crossings) const {
    return start + step * static_cast<std::int32_t>(crossings);
  }
};

/// A ray in units of voxels, turned so that x does not fall along it.
struct RayLine {
  std::array<FaceCrossings, 3> axes;
  double start_x = 0.0;  ///< voxels
  double slope_x = 0.0;  ///< of x over the position, 0..1
  RayPosition carve_from = 0;
  RayPosition carve_to = -1;  ///< included; before carve_from: nothing is carved

  bool carves() const { return carve_from <= carve_to; }
};

/// The part of a ray that is carved. `start` and `end` in voxels, at most max_ray_voxels apart.
/// `protected_share` is the part of the ray before its end that is not carved, 0..1; a voxel that
/// this part touches is not either. None: the end voxel is carved too.
RayLine carved_line(const Eigen::Vector3d& start,
                    const Eigen::Vector3d& end,
                    std::optional<double> protected_share,
                    const std::optional<LayerRange>& layers);

}  // namespace kissmap::occupancy
