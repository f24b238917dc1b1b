// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <vector>

#include "kissmap/grid/floor_map.hpp"

namespace kissmap {

/// Splits a path into the storeys it goes through: for each pose its level, counted from 0 in the
/// order of their mean heights.
///
/// Two poses are on different levels if one is over the other: nearly at the same place in the
/// plane, but higher by more than a slope explains. A path that never meets itself so has one
/// level, however hilly. Between two levels the cut is on the way up or down; stretches between
/// cuts that lie on the same floor are one level. Pure.
std::vector<std::uint32_t> levels_of(const SensorPath& path);

}  // namespace kissmap
