// SPDX-License-Identifier: MIT
#pragma once

#include <vector>

#include "support/occupancy_plan.hpp"

namespace kissmap {

/// Exact distance [m] from the middle of each cell to that of the nearest occupied one; more than
/// any map is wide where there is none.
std::vector<double> distances_to_occupied(const OccupancyPlan& plan);

}  // namespace kissmap
