// SPDX-License-Identifier: MIT
#pragma once

#include "kissmap/formats/session.hpp"

namespace kissmap {

/// Sides [m] that suit what a sensor saw.
struct FittingResolution {
  double cell = 0.0;   ///< of a 2D map: 0.05 where returns are 8 m away on average, as in rooms,
                       ///< 0.1 up to 20 m, else 0.2
  double voxel = 0.0;  ///< of a 3D map: 0.05 in rooms, else 0.2
};

/// Looks at 50 scans or a few more, evenly picked, between the ranges [m]. Throws as SessionReplay
/// does.
FittingResolution fitting_resolution(const Session& session,
                                     double min_range,
                                     double max_range,
                                     const std::filesystem::path& moved_log);

}  // namespace kissmap
