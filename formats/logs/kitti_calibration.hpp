// SPDX-License-Identifier: MIT
#pragma once

#include <filesystem>

#include "kissmap/geometry/rigid3.hpp"

namespace kissmap {

/// The pose of the LiDAR in the frame of camera 0 (z forward, y down), the frame of KITTI's poses:
/// line "Tr:" or "Tr_velo_to_cam:" of calib.txt, row-major 3x4. Layout: readme.txt of KITTI's
/// odometry development kit; the second name is that of its object data set. Throws Error(input).
Rigid3 read_kitti_cam0_from_lidar(const std::filesystem::path& calib_txt);

}  // namespace kissmap
