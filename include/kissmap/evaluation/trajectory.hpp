// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "kissmap/geometry/rigid3.hpp"

namespace kissmap {

/// Poses of a sensor over time, world_from_sensor, in metres. Any world frame will do.
struct Trajectory {
  std::vector<std::int64_t> stamps_ns;  ///< one a pose, never falling; or none at all
  std::vector<Rigid3> poses;
  bool positions_only = false;  ///< rotations are not known, and identity here

  bool has_stamps() const { return !stamps_ns.empty(); }
  std::size_t size() const { return poses.size(); }
};

/// Throws Error(input) unless the stamps are as described above and all poses are finite.
void require_valid(const Trajectory& trajectory);

/// Length of the way from the first pose to each pose, along straight lines between poses [m].
/// As long as `poses`; starts with 0 and never falls.
std::vector<double> distances_along(const std::vector<Rigid3>& poses);

}  // namespace kissmap
