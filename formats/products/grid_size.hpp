// SPDX-License-Identifier: MIT
#pragma once

#include <Eigen/Geometry>
#include <cstdint>

#include "kissmap/formats/grid_export.hpp"

namespace kissmap {

/// Of what `seen` [m] holds, the part that becomes cells, and what is needed around it. Throws
/// Error(usage) where nothing of it is in the crop.
Eigen::AlignedBox2d worked_area(const Eigen::AlignedBox2d& seen, const GridExportOptions& options);

/// What the cells of maps of a rectangle [m] take while they are made [bytes].
double cell_bytes(const Eigen::AlignedBox2d& area, double resolution, std::uint32_t levels);

/// The resolution asked for, or, where none is, `fitting` or the first of its doubles whose cells
/// fit into options.max_memory. Throws Error(usage) with the cure if they do not fit.
double resolution_in_memory(double fitting,
                            const Eigen::AlignedBox2d& seen,
                            std::uint32_t levels,
                            const GridExportOptions& options);

}  // namespace kissmap
