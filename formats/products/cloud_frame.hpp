// SPDX-License-Identifier: MIT
#pragma once

#include <Eigen/Geometry>

#include "kissmap/formats/session.hpp"

namespace kissmap {

/// What the scans of a session can reach at most [m, map frame].
Eigen::AlignedBox3d reach_of(const Session& session, double max_range);

/// What single precision coordinates are to be relative to: nothing where all of the box is within
/// 8192 m of the origin and steps stay below half a millimetre, else its middle in whole
/// kilometres.
Eigen::Vector3d single_precision_offset(const Eigen::AlignedBox3d& box);

/// The middle of the box in whole metres.
Eigen::Vector3d whole_metre_centre(const Eigen::AlignedBox3d& box);

}  // namespace kissmap
