// SPDX-License-Identifier: MIT
#pragma once

#include "kissmap/formats/scan_writer.hpp"

namespace kissmap {

/// The functions behind open_scan_writer.
std::unique_ptr<ScanWriter> open_pcd_folder_writer(const std::filesystem::path& path);
std::unique_ptr<ScanWriter> open_kitti_writer(const std::filesystem::path& path);
std::unique_ptr<ScanWriter> open_mcap_scan_writer(const std::filesystem::path& path);

}  // namespace kissmap
