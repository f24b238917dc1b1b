// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>

#include "kissmap/geometry/rigid3.hpp"
#include "kissmap/graph/pose_graph.hpp"

namespace kissmap {

/// Two scans the surfaces around which were registered to each other.
struct SurfaceLink {
  std::uint32_t reference_scan = 0;  ///< middle scan of a stretch of the way
  std::uint32_t query_scan = 0;      ///< that of another one, or any scan near the stretch
  Rigid3 reference_from_query;       ///< between the lidar frames of the two
  Information information = Information::Zero();
};

}  // namespace kissmap
