// SPDX-License-Identifier: MIT
#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "kissmap/geometry/rigid3.hpp"
#include "kissmap/odometry/voxel_hash_map.hpp"
#include "kissmap/parallel/thread_pool.hpp"

namespace kissmap {

struct RegistrationOptions {
  int max_iterations = 500;  ///< stops earlier once the step is small
  double min_update = 1e-4;  ///< norm of a step (m and rad mixed, as published) that ends it
};

/// Where a scan was found to be.
struct Alignment {
  enum class End {
    converged,
    max_iterations,
    no_pairs,    ///< nothing of the scan is near the map
    degenerate,  ///< the pairs do not determine a step
  };
  Rigid3 map_from_lidar;
  End end = End::converged;
  int iterations = 0;
  std::size_t pairs = 0;  ///< in the last iteration
};

/// Robust point-to-point ICP of a scan against a map (KISS-ICP, section III-D): each point is
/// paired with its nearest map point, residuals r weighted by sigma^2 / (sigma + r^2)^2.
///
/// A pair is searched anew only when it may have changed: see VoxelHashMap::Neighbor. The result
/// is that of searching every time. Sums run over fixed chunks combined in order, so the answer is
/// bit-identical for any number of threads. Keeps its working memory between calls.
class Registration {
 public:
  Registration(const RegistrationOptions& options, ThreadPool& pool);

  /// `source` in the lidar frame [m]; pairs farther apart than max_pair_distance [m] are dropped.
  /// An empty map, or no pair at all, ends at once with the guess (End::no_pairs).
  Alignment align(std::span<const Eigen::Vector3f> source,
                  const VoxelHashMap& map,
                  const Rigid3& guess_map_from_lidar,
                  double max_pair_distance,
                  double sigma);

 private:
  struct Pair {
    Eigen::Vector3f searched_from;  ///< map frame
    VoxelHashMap::Neighbor neighbor;
    VoxelKey voxel = no_voxel;  ///< of searched_from; no_voxel before the first search
  };
  /// Sums over pairs, with q the moved source point, r = q - target and w its weight. As the
  /// Jacobian of a pair is [I | -q x], these 16 numbers hold all of J'WJ and J'Wr.
  struct Sums {
    double w = 0.0;
    Eigen::Vector3d wq = Eigen::Vector3d::Zero();
    Eigen::Matrix3d wqq = Eigen::Matrix3d::Zero();
    Eigen::Vector3d wr = Eigen::Vector3d::Zero();
    Eigen::Vector3d wqr = Eigen::Vector3d::Zero();
    std::size_t pairs = 0;
  };

  Sums accumulate(std::span<const Eigen::Vector3f> source,
                  const VoxelHashMap& map,
                  const Rigid3& map_from_lidar,
                  double max_pair_distance,
                  double sigma);
  static Twist solve(const Sums& sums);

  RegistrationOptions options_;
  ThreadPool& pool_;
  std::vector<Pair> pairs_;
  std::vector<Sums> chunk_sums_;
};

}  // namespace kissmap
