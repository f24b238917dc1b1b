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
  bool interpolate = false;
  /// s; where interpolated: poses farther apart say nothing of what lies between them. A quarter
  /// of a second at 5 m/s2 hides 4 cm.
  double max_gap = 0.25;
};
/// Throws Error(usage) naming the option.
void require_valid(const AssociationOptions& options);

/// Poses of two trajectories that belong together: reference[i] with estimate[i].
struct PosePairs {
  enum class Side { neither, reference, estimate };

  /// Of the reference, else of the estimate; or none at all. Of what is not interpolated, by the
  /// clock of the reference.
  std::vector<std::int64_t> stamps_ns;
  std::vector<Rigid3> reference;           ///< reference_from_sensor
  std::vector<Rigid3> estimate;            ///< map_from_sensor
  std::vector<std::size_t> reference_idx;  ///< where interpolated: of the pose at or before it
  std::vector<std::size_t> estimate_idx;
  bool by_stamp = false;  ///< else by index
  Side interpolated = Side::neither;
  bool positions_only = false;  ///< of one of them rotations are not known

  std::size_t size() const { return reference.size(); }
};

/// Pairs by stamp: each pose of the trajectory with fewer poses (the estimate, if both have as
/// many) takes the pose of the other that is nearest in time, the earlier of two equally near, if
/// it is within the tolerance. A pose of the longer one may serve several times. This is the rule
/// of evo (evo/core/sync.py), and as there stamps are compared as double seconds: to 0.2 us for
/// stamps since 1970.
///
/// With `interpolate`: each pose of one trajectory takes the pose of the other at its very instant,
/// by constant twist (a screw motion) between the two neighbours in time, if these are within
/// `max_gap`, whatever the tolerance; a pose with the same stamp is taken as it is. Nothing is
/// extrapolated. The reference is the one interpolated, since its poses are the smoother ones,
/// unless it is the sparser: the median step of its stamps more than twice that of the estimate
/// (control points, a reference of a pose a second). Stamps are compared as nanoseconds.
///
/// Where one of them has no stamps, pairs by index. Throws Error(input) when nothing belongs
/// together (the message gives both spans of time), for unequal counts without stamps, and where
/// stamps to interpolate by are missing. O(n log n).
PosePairs associate(const Trajectory& reference,
                    const Trajectory& estimate,
                    const AssociationOptions& options = {});

}  // namespace kissmap
