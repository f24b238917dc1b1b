// SPDX-License-Identifier: MIT
#pragma once

#include <span>

#include "grid/height_field.hpp"
#include "kissmap/grid/floor_map.hpp"

namespace kissmap {

/// Heights of the surfaces reached from under the path, over all columns of the samples. Dijkstra's
/// algorithm over the surfaces; each column takes the first that is reached.
HeightField grow_floor(const SensorPath& path,
                       std::span<const FloorSample> samples,
                       double cell_size,
                       double sensor_height);

}  // namespace kissmap
