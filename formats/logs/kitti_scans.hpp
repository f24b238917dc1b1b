// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <span>

#include "kissmap/cloud/scan.hpp"
#include "kissmap/formats/scan_log.hpp"

namespace kissmap {

/// KITTI's rows have four columns. Throws Error(usage) if --bin-columns says otherwise.
void require_kitti_columns(const ReadOptions& options);

/// Raises the elevation of a return by 0.205 degrees; range and azimuth stay. The vertical angles
/// in the HDL-64E calibration KITTI was decoded with are too low by that much (found by Deschaud,
/// IMLS-SLAM, 2018; KISS-ICP and CT-ICP correct it too). A point on the z axis stays.
Eigen::Vector3f raised_by_kitti_correction(const Eigen::Vector3f& point);

/// Part of the sweep, 0..1, at which the HDL-64E of KITTI saw a direction: it begins at the rear
/// and turns clockwise seen from above; the front is passed at 0.5.
double kitti_sweep_fraction(const Eigen::Vector3f& point);

}  // namespace kissmap
