// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <vector>

#include "kissmap/geometry/rigid3.hpp"

namespace kissmap {

struct KittiOptions {
  /// Lengths of segments [m]. The benchmark's are 100, 200 .. 800.
  std::vector<double> lengths = {100, 200, 300, 400, 500, 600, 700, 800};
  std::size_t step = 10;  ///< a segment begins at every such pose
};
/// Throws Error(usage) unless there are lengths, all positive and finite, and step > 0.
void require_valid(const KittiOptions& options);

/// Lengths for a way of this length [m]: the benchmark's from 200 m, 1, 2 .. 10 m from 20 m, else
/// 0.1, 0.2 .. 1 m.
std::vector<double> kitti_lengths_for(double path_length);

/// Mean error over the segments of one length, or over all.
struct KittiMean {
  double length = 0.0;       ///< m; 0 for the mean over all
  std::size_t segments = 0;  ///< without segments the means are 0 and mean nothing
  double translation = 0.0;  ///< m per m
  double rotation = 0.0;     ///< rad per m
};
struct KittiError {
  KittiMean overall;               ///< over all segments of all lengths, as the benchmark ranks
  std::vector<KittiMean> lengths;  ///< one for each length asked for
};

/// The odometry benchmark of KITTI (Geiger et al., CVPR 2012; devkit, evaluate_odometry.cpp): a
/// segment goes from every `step`-th pose to the first one that is more than `length` farther along
/// the reference, and its error is that of the motion between the two, divided by `length`.
/// Distances in double precision where the devkit has float.
KittiError kitti_error(const std::vector<Rigid3>& reference,
                       const std::vector<Rigid3>& estimate,
                       const KittiOptions& options = {});

}  // namespace kissmap
