// SPDX-License-Identifier: MIT
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "kissmap/parallel/thread_pool.hpp"

namespace kissmap::occupancy {

/// normal . p = offset; a normal of zero stands for no plane.
struct DirectionPlane {
  Eigen::Vector3f normal = Eigen::Vector3f::Zero();
  float offset = 0.0F;
  bool found() const { return normal.x() != 0.0F || normal.y() != 0.0F || normal.z() != 0.0F; }
};

/// Azimuth and elevation of a ray in cells of the finest level.
struct DirectionCell {
  std::int32_t column = 0;
  std::int32_t row = 0;
};
DirectionCell direction_cell(const Eigen::Vector3f& direction);

/// Planes fitted to points that are neighbours as seen from the sensor, on four levels of cells.
class DirectionPlanes {
 public:
  /// Points [m] with their cells and their distances from the sensor [m].
  DirectionPlanes(std::span<const Eigen::Vector3f> points,
                  std::span<const DirectionCell> cells,
                  std::span<const float> ranges,
                  ThreadPool& pool);

  static constexpr int levels = 4;

  /// The planes that may hold for a direction: those of its cell and of the 8 around it. Some are
  /// not found. Level 0 has the smallest cells.
  using Neighbors = std::array<const DirectionPlane*, 9>;
  Neighbors around(int level, const DirectionCell& cell) const;

 private:
  struct Sums;
  using Grid = std::vector<Sums>;

  static Grid coarser(const Grid& fine, int coarse_level);
  static DirectionPlane fit(const Grid& sums, int level, std::int32_t column, std::int32_t row);

  std::array<std::vector<DirectionPlane>, levels> planes_;
};

}  // namespace kissmap::occupancy
