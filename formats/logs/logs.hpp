// SPDX-License-Identifier: MIT
#pragma once

#include <filesystem>
#include <memory>

#include "kissmap/formats/scan_log.hpp"

namespace kissmap {

/// The functions behind the list in registry.cpp; their promises are those of LogFormat.
bool probe_kitti_odometry(const std::filesystem::path& path);
std::unique_ptr<ScanLog> open_kitti_odometry(const std::filesystem::path& path,
                                             const ReadOptions& options);

bool probe_kitti_raw(const std::filesystem::path& path);
std::unique_ptr<ScanLog> open_kitti_raw(const std::filesystem::path& path,
                                        const ReadOptions& options);

bool probe_point_folder(const std::filesystem::path& path);
std::unique_ptr<ScanLog> open_point_folder(const std::filesystem::path& path,
                                           const ReadOptions& options);

}  // namespace kissmap
