// SPDX-License-Identifier: MIT
#pragma once

#include "kissmap/formats/session.hpp"

namespace kissmap {

/// The side of a cell or voxel [m] that suits what the sensor saw: 0.05 m where returns are 8 m
/// away on average, as in rooms, 0.1 m up to 20 m, else 0.2 m. Looks at 50 scans or a few more,
/// evenly picked, between the ranges [m]. Throws as SessionReplay does.
double fitting_resolution(const Session& session,
                          double min_range,
                          double max_range,
                          const std::filesystem::path& moved_log);

}  // namespace kissmap
