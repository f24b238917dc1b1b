// SPDX-License-Identifier: MIT
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <unordered_map>
#include <vector>

#include "kissmap/cloud/voxel.hpp"
#include "kissmap/geometry/rigid3.hpp"
#include "kissmap/mapping/placed_scan.hpp"

namespace kissmap {

/// A piece of a surface that might be floor: what was seen in one column of cells, at one height.
struct FloorSample {
  std::int32_t x = 0;  ///< column, in cells: covers [x c, (x+1) c)
  std::int32_t y = 0;
  float z = 0.0F;             ///< m, level frame; mean of the points, near ones count more
  float weight = 0.0F;        ///< points, each by how near it was
  bool below_others = false;  ///< something was seen 0.2 to 0.7 m above it, as on a wall
};

/// Gathers from scans what might be floor, in memory that grows with the area, not with the log.
/// Columns of cells hold the mean heights of their points in slices of a tenth of a metre. Only
/// what is seen from above counts: the ceiling of a storey is no floor of the next. Not thread
/// safe.
class FloorSampler {
 public:
  /// `cell_size` > 0 and `reach` > 0 [m]: farther points tell little of heights.
  FloorSampler(double cell_size, double reach);

  void add(const PlacedScan& scan, const Rigid3& level_from_map);

  double cell_size() const { return cell_size_; }

  /// One sample for each surface, ordered by x, y, z. A surface that goes on upwards (a wall) is
  /// given by its foot.
  std::vector<FloorSample> samples() const;

 private:
  struct Slice {
    float weight = 0.0F;
    float height_sum = 0.0F;  ///< m above the slice's lower end, weighted
    float from_below = 0.0F;  ///< weight of points that are above their sensor
  };

  bool something_above(const Voxel& place) const;

  double cell_size_;
  double reach_;
  std::unordered_map<VoxelKey, Slice> slices_;
};

}  // namespace kissmap
