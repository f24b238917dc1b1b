// SPDX-License-Identifier: MIT
#include "formats/voxels/voxel_files.hpp"
#include "kissmap/formats/cloud_writer.hpp"

namespace kissmap {
namespace {

class VoxelCloudWriter : public VoxelWriter {
 public:
  VoxelCloudWriter(const std::filesystem::path& path, const VoxelWriterOptions& options) {
    CloudWriterOptions cloud;
    cloud.fields.intensity = true;
    cloud.frame = options.frame;
    cloud.offset = options.offset;
    cloud_ = open_cloud_writer(path, cloud);
  }

  void add(const OccupancyMap& part) override {
    part.for_each_voxel([&](const Voxel& voxel, LogOdds value) {
      if (!part.steps().is_occupied(value)) return;
      CloudPoint point;
      point.point.position = voxel_center(part.geometry(), voxel);
      point.point.intensity = static_cast<float>(part.steps().probability(value));
      cloud_->add(point);
    });
  }

  void finish() override { cloud_->finish(); }

 private:
  std::unique_ptr<CloudWriter> cloud_;
};

}  // namespace

std::unique_ptr<VoxelWriter> open_voxel_cloud_writer(const std::filesystem::path& path,
                                                     const VoxelWriterOptions& options) {
  return std::make_unique<VoxelCloudWriter>(path, options);
}

}  // namespace kissmap
