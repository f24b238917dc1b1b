// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <span>

#include "formats/clouds/record_layout.hpp"

namespace kissmap {

/// Reads the points of a LAS file 1.0 to 1.4, formats 0 to 10, not compressed: x y z [m],
/// intensity, and gps_time where the format has it, which is not taken for a time in the sweep
/// unless asked for by name. Throws Refusal, for LAZ by name. Specification: ASPRS LAS 1.4 R15.
PointRecords read_las(std::span<const std::byte> file);

}  // namespace kissmap
