// SPDX-License-Identifier: MIT
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <vector>

namespace kissmap {

/// What stands alone in a cloud (Rusu et al., "Towards 3D Point Cloud Based Object Maps for
/// Household Environments", 2008).
struct OutlierOptions {
  int neighbors = 10;           ///< whose mean distance is taken
  double max_deviations = 2.0;  ///< standard deviations above the mean over the cloud
};

/// Indices, ascending, of the points whose mean distance to their neighbours is at most the mean
/// over all points plus max_deviations standard deviations. Coordinates are finite, in metres, and
/// small enough for single precision. With no more points than neighbours, all. Deterministic;
/// about 32 bytes a point beside the input.
std::vector<std::uint32_t> find_inliers(std::span<const Eigen::Vector3f> points,
                                        const OutlierOptions& options = {});

}  // namespace kissmap
