// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "kissmap/evaluation/trajectory.hpp"

namespace kissmap {

struct AssociationOptions {
  double tolerance = 0.01;  ///< s; stamps farther apart do not belong together
  double offset = 0.0;      ///< s; added to the stamps of the estimate
};
/// Throws Error(usage) naming the option.
void require_valid(const AssociationOptions& options);

/// Poses of two trajectories that belong together: reference[i] with estimate[i].
struct PosePairs {
  std::vector<std::int64_t> stamps_ns;  ///< of the reference, else of the estimate; or none at all
  std::vector<Rigid3> reference;        ///< reference_from_sensor
  std::vector<Rigid3> estimate;         ///< map_from_sensor
  std::vector<std::size_t> reference_idx;
  std::vector<std::size_t> estimate_idx;
  bool by_stamp = false;        ///< else by index
  bool positions_only = false;  ///< of one of them rotations are not known

  std::size_t size() const { return reference.size(); }
};

/// Pairs by stamp: each pose of the trajectory with fewer poses (the estimate, if both have as
/// many) takes the pose of the other that is nearest in time, the earlier of two equally near, if
/// it is within the tolerance. A pose of the longer one may serve several times. This is the rule
/// of evo (evo/core/sync.py), and as there stamps are compared as double seconds: to 0.2 us for
/// stamps since 1970.
/// Where one of them has no stamps, pairs by index. Throws Error(input) when nothing belongs
/// together (the message gives both spans of time), and for unequal counts without stamps.
/// O(n log n).
PosePairs associate(const Trajectory& reference,
                    const Trajectory& estimate,
                    const AssociationOptions& options = {});

}  // namespace kissmap
