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

bool probe_ros1_bag(const std::filesystem::path& path);
std::unique_ptr<ScanLog> open_ros1_bag_log(const std::filesystem::path& path,
                                           const ReadOptions& options);

bool probe_ros2_bag(const std::filesystem::path& path);
std::unique_ptr<ScanLog> open_ros2_bag_log(const std::filesystem::path& path,
                                           const ReadOptions& options);

bool probe_capture(const std::filesystem::path& path);
std::unique_ptr<ScanLog> open_capture(const std::filesystem::path& path,
                                      const ReadOptions& options);

bool probe_lvx(const std::filesystem::path& path);
std::unique_ptr<ScanLog> open_lvx(const std::filesystem::path& path, const ReadOptions& options);

bool probe_mcap(const std::filesystem::path& path);
std::unique_ptr<ScanLog> open_mcap_log(const std::filesystem::path& path,
                                       const ReadOptions& options);

}  // namespace kissmap
