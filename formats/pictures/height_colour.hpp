// SPDX-License-Identifier: MIT
#pragma once

#include <Eigen/Core>

namespace kissmap {

/// Colour (red, green, blue, 0..1) of a height that is `share` of the way up, 0..1: from low to
/// high blue, cyan, green, yellow, all of about the same lightness.
Eigen::Array3f height_colour(float share);

}  // namespace kissmap
