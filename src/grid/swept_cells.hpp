// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <unordered_map>

#include "kissmap/grid/floor_map.hpp"
#include "kissmap/occupancy/occupancy_map.hpp"

namespace kissmap {

/// The cells that the sensor's carrier went over, and up to which height.
class SweptCells {
 public:
  /// Of the cells of a block of voxels, as in OccupancyBlock: m above the floor up to which the
  /// carrier filled the space over them, minus infinity where it did not.
  using BlockHeights =
      std::array<float, static_cast<std::size_t>(occupancy_block_side* occupancy_block_side)>;

  explicit SweptCells(double resolution) : resolution_(resolution) {}

  /// A stretch of the way of the sensor, whose carrier reaches `half_width` [m] to all sides.
  /// Between poses that are over 3 m apart it went somewhere, nobody knows where.
  void add(const SensorPath& stretch, const FloorMap& floor, double half_width);

  /// Null where no cell of the block was gone over. `x`, `y`: first cell of the block.
  const BlockHeights* in_block(std::int32_t x, std::int32_t y) const;

 private:
  void add_disc(const Eigen::Vector3d& sensor, const FloorMap& floor, double half_width);

  double resolution_;
  std::unordered_map<VoxelKey, BlockHeights> blocks_;
};

}  // namespace kissmap
