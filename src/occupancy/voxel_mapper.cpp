// SPDX-License-Identifier: MIT
#include "kissmap/occupancy/voxel_mapper.hpp"

#include "occupancy/scan_rays.hpp"
#include "options.hpp"

namespace kissmap {

VoxelMapper::VoxelMapper(const OccupancyGeometry& geometry, const VoxelMapperOptions& options)
    : options_(options), map_(geometry, options.occupancy) {
  require_between("no-return range", options.no_return_range, 0.0, 1000.0);
}

OccupancyUpdate VoxelMapper::add(const PlacedScan& scan, ThreadPool& pool) {
  occupancy::ScanRays rays =
      occupancy::rays_of(scan, scan.map_from_lidar, options_.no_return_range);
  rays.margins = grazing_margins(rays.view(), map_.geometry().voxel_size, options_.grazing, pool);
  return map_.add(rays.view(), pool);
}

}  // namespace kissmap
