// SPDX-License-Identifier: MIT
#include "formats/voxels/voxel_files.hpp"
#include "kissmap/formats/cloud_writer.hpp"

namespace kissmap {

void write_voxel_cloud(const OccupancyMap& map,
                       const std::filesystem::path& path,
                       const VoxelWriterOptions& options) {
  CloudWriterOptions cloud;
  cloud.fields.intensity = true;
  cloud.frame = options.frame;
  const auto writer = open_cloud_writer(path, cloud);
  map.for_each_voxel([&](const Voxel& voxel, LogOdds value) {
    if (!map.steps().is_occupied(value)) return;
    CloudPoint point;
    point.point.position = voxel_center(map.geometry(), voxel);
    point.point.intensity = static_cast<float>(map.steps().probability(value));
    writer->add(point);
  });
  writer->finish();
}

}  // namespace kissmap
