// SPDX-License-Identifier: MIT
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <memory>

#include "kissmap/geometry/rigid3.hpp"
#include "kissmap/grid/floor_map.hpp"
#include "kissmap/grid/grid_map.hpp"
#include "kissmap/grid/upright_columns.hpp"
#include "kissmap/mapping/placed_scan.hpp"
#include "kissmap/occupancy/log_odds.hpp"
#include "kissmap/occupancy/occupancy_map.hpp"
#include "kissmap/parallel/thread_pool.hpp"

namespace kissmap {

/// The heights above the floor that a 2D map looks at, and its cells.
struct GridBand {
  double z_min = 0.1;        ///< m above the floor
  double z_max = 1.8;        ///< m above the floor
  double resolution = 0.05;  ///< m
  double max_range = 100.0;  ///< m; rays are cut there
};
/// Throws Error(usage) naming the field, its value and its range.
void require_valid(const GridBand& band);

/// How the band's voxels are believed. Seeing through a voxel counts half of what is usual: a
/// chair's leg fills a small part of a voxel, and rays pass beside it.
struct BandBelief {
  LogOddsOptions log_odds{0.7, 0.45, 0.12, 0.97, 0.5};
  double free_margin = 0.1;  ///< m before a hit that are not taken for free
  /// m, 0..1000; rays of which nothing came back are free up to here, 0: they say nothing
  double no_return_range = 0.0;
};

/// For bands of one or two layers, where a chair's leg is hit seldom and seen past often, by
/// poses that are good to a few centimetres: a look through counts a third of what is usual.
inline constexpr BandBelief localization_belief{{0.7, 0.465, 0.12, 0.97, 0.5}, 0.1, 0.0};

/// 3D occupancy of a band above the floor, and the 2D map it makes.
///
/// Rays are cast through voxels whose z is the height above the floor: layers of them begin exactly
/// at z_min and end exactly at z_max, and they follow ramps and hills. A ray is bent where the
/// floor is, by straight pieces that are off by two centimetres at most. Rays are cast before
/// anything is cut off in z. Same result for any number of threads. Not thread safe.
class BandMapper {
 public:
  /// With `upright`, which must outlive this, returns where the floor was not seen count only if it
  /// holds them: a floor that lies higher than guessed is no obstacle.
  BandMapper(const FloorMap& floor,
             const GridBand& band,
             const BandBelief& belief = {},
             const UprightColumns* upright = nullptr);
  ~BandMapper();

  /// Casts the rays of a scan. `level_from_map` as for the floor.
  void add(const PlacedScan& scan, const Rigid3& level_from_map, ThreadPool& pool);

  /// A stretch of the way of the sensor [level frame], whose carrier reaches `half_width` [m] to
  /// all sides: what stood there, and no higher than the sensor, cannot be in its way in the end.
  void clear_way(const SensorPath& stretch, double half_width);

  /// The map of all columns seen, empty if there are none. Cells are aligned to multiples of the
  /// resolution. `area` [m]: only what is in it, and up to 8 cells beyond.
  GridMap grid(const ColumnRule& rule, const Eigen::AlignedBox2d& area = everywhere()) const;

  /// What rays were cast into; may be limited to a part of the plane.
  OccupancyMap& voxels();

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace kissmap
