// SPDX-License-Identifier: MIT
#pragma once

#include "kissmap/mapping/placed_scan.hpp"
#include "kissmap/occupancy/grazing_margin.hpp"
#include "kissmap/occupancy/occupancy_map.hpp"

namespace kissmap {

struct VoxelMapperOptions {
  OccupancyOptions occupancy;
  GrazingOptions grazing{0.1, 0.03};
  /// m; rays of which nothing came back are free up to here, where the log tells them. 0: they say
  /// nothing, as black paint and glass swallow rays, too.
  double no_return_range = 0.0;
};

/// 3D occupancy of scans in their places: each ray from where the sensor was when it saw the point,
/// free up to grazing_margins() before its end.
/// Same result for any number of threads. Not thread safe.
class VoxelMapper {
 public:
  /// Throws Error(usage) naming the field that is out of range.
  explicit VoxelMapper(const OccupancyGeometry& geometry, const VoxelMapperOptions& options = {});

  /// Casts the rays of a scan into the frame that its map_from_lidar leads to.
  OccupancyUpdate add(const PlacedScan& scan, ThreadPool& pool);

  const OccupancyMap& map() const { return map_; }
  OccupancyMap& map() { return map_; }

 private:
  VoxelMapperOptions options_;
  OccupancyMap map_;
};

}  // namespace kissmap
