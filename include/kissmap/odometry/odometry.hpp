// SPDX-License-Identifier: MIT
#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>
#include <vector>

#include "kissmap/cloud/scan.hpp"
#include "kissmap/cloud/voxel_filter.hpp"
#include "kissmap/geometry/rigid3.hpp"
#include "kissmap/odometry/adaptive_threshold.hpp"
#include "kissmap/odometry/adaptive_voxel_size.hpp"
#include "kissmap/odometry/preprocess.hpp"
#include "kissmap/odometry/registration.hpp"
#include "kissmap/odometry/voxel_hash_map.hpp"
#include "kissmap/parallel/thread_pool.hpp"

namespace kissmap {

/// METHOD section 1. One set of defaults serves every sensor and place.
struct OdometryOptions {
  double max_range = 100.0;  ///< m; farther points are dropped
  double min_range = 0.0;    ///< m; nearer points are dropped
  /// m, of the odometry's map; 0 means max_range / 100, and finer where the surroundings are near
  double voxel_size = 0.0;
  bool deskew = true;              ///< undo the motion inside a sweep where there are times
  int max_points_per_voxel = 20;   ///< of the odometry's map
  double initial_threshold = 2.0;  ///< m; sigma of the motion model before any scan
  double min_motion = 0.1;         ///< m; model errors below it do not change sigma
  RegistrationOptions registration;
};
/// Throws Error(usage) naming the field, its value and its range.
void require_valid(const OdometryOptions& options);

/// A scan in its place. Spans stay valid until the next call.
struct RegisteredScan {
  Rigid3 frame_from_lidar;  ///< at the sweep's end if deskewed, else at the scan's stamp
  bool deskewed = false;
  Rigid3 sweep_start_from_sweep_end;  ///< motion used to deskew, or identity
  Alignment::End end = Alignment::End::converged;
  int iterations = 0;
  double sigma = 0.0;       ///< m, threshold used
  double mean_range = 0.0;  ///< m, of map_points
  std::size_t points_in_range = 0;
  std::span<const Eigen::Vector3f> map_points;  ///< thinned to half a voxel, odometry frame
};

/// KISS-ICP (Vizzo et al., RA-L 2023): scan-to-map odometry, with voxels that become finer where
/// the surroundings are near. The frame is that of the first scan, or of the latest restart(). Same
/// result for any number of threads of the pool. Not thread safe; allocates nothing per scan in the
/// steady state.
class Odometry {
 public:
  Odometry(const OdometryOptions& options, ThreadPool& pool);

  /// Takes the next scan. Empty, with no change of state, if no point lies in range.
  std::optional<RegisteredScan> register_scan(const Scan& scan);

  /// Makes the last scan's pose the new frame: it becomes the identity, the map moves with it.
  void restart_frame();

  const VoxelHashMap& map() const { return map_; }

 private:
  Rigid3 motion_through_sweep(const Scan& scan) const;
  void thin();
  bool fit_voxels(double mean_range);

  OdometryOptions options_;
  AdaptiveVoxelSize voxel_size_;
  ThreadPool& pool_;
  VoxelHashMap map_;
  AdaptiveThreshold threshold_;
  Registration registration_;
  Rigid3 frame_from_last_;
  Rigid3 last_motion_;  ///< lidar before last <- last lidar
  std::optional<std::int64_t> last_stamp_;
  double last_interval_ = 0.0;  ///< s between the last two scans; 0 if unknown

  VoxelFilter filter_;
  std::vector<Eigen::Vector3f> in_range_;  ///< lidar frame, sweep end
  std::vector<Eigen::Vector3f> thinned_;   ///< to half a voxel; moved to the frame afterwards
  std::vector<Eigen::Vector3f> source_;    ///< to one and a half voxels
};

}  // namespace kissmap
