// SPDX-License-Identifier: MIT
#pragma once

namespace kissmap {

/// How fine the odometry's map has to be where the sensor is: voxels that suit a street hide the
/// rooms of a building. Halves the voxel, and halves it again, where the surroundings are near;
/// doubles it back where they open. What is near is measured in voxels, by the mean range of the
/// scans, smoothed over 2 s at 10 Hz; between the two limits nothing changes.
class AdaptiveVoxelSize {
 public:
  /// The voxel in the open [m].
  explicit AdaptiveVoxelSize(double coarsest);

  double meters() const { return voxel_size_; }

  /// Takes the mean range [m] of one scan's points, thinned to half a voxel. True if the size is
  /// another one from now on.
  bool observe(double mean_range);

 private:
  double voxel_size_;
  double mean_range_ = 0.0;  ///< m, smoothed; 0 before the first scan
  int halvings_ = 0;
};

}  // namespace kissmap
