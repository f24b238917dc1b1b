// SPDX-License-Identifier: MIT
#include "kissmap/odometry/adaptive_voxel_size.hpp"

namespace kissmap {
namespace {

constexpr int most_halvings = 2;
constexpr double near = 14.0;  // voxels; streets stay above 19, offices below 10
constexpr double far = 36.0;   // voxels; more than twice `near`, so that sizes do not alternate
constexpr double smoothing = 20.0;  // scans

}  // namespace

AdaptiveVoxelSize::AdaptiveVoxelSize(double coarsest) : voxel_size_(coarsest) {
}

bool AdaptiveVoxelSize::observe(double mean_range) {
  mean_range_ =
      mean_range_ > 0.0 ? mean_range_ + (mean_range - mean_range_) / smoothing : mean_range;
  if (mean_range_ < near * voxel_size_ && halvings_ < most_halvings) {
    voxel_size_ /= 2.0;
    ++halvings_;
    return true;
  }
  if (mean_range_ > far * voxel_size_ && halvings_ > 0) {
    voxel_size_ *= 2.0;
    --halvings_;
    return true;
  }
  return false;
}

}  // namespace kissmap
