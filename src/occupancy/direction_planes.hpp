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

  /// The planes that may hold for a direction: of its cell and the cells around it, on all levels.
  /// Some are not found.
  static constexpr std::size_t candidates = 36;
  std::array<const DirectionPlane*, candidates> around(const DirectionCell& cell) const;

 private:
  static constexpr int levels = 4;
  struct Sums;
  using Grid = std::vector<Sums>;

  static Grid coarser(const Grid& fine, int coarse_level);
  static DirectionPlane fit(const Grid& sums, int level, std::int32_t column, std::int32_t row);
  const DirectionPlane& plane(int level, std::int32_t column, std::int32_t row) const;

  std::array<std::vector<DirectionPlane>, levels> planes_;
};

}  // namespace kissmap::occupancy
