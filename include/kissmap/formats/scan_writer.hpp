// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>

#include "kissmap/cloud/scan.hpp"

namespace kissmap {

/// A log being written scan by scan, for other programs. It appears under its name when finish()
/// has been called; without that nothing stays. Same scans, same bytes. Every member throws
/// Error(output) naming the file. Not thread safe.
class ScanWriter {
 public:
  virtual ~ScanWriter() = default;
  virtual void add(const Scan& scan) = 0;
  virtual void finish() = 0;
};

/// What a log can be written as.
/// - pcd: a folder of 000000.pcd ... with x y z, intensity and `time` (s since the stamp) where the
///   log has them, and times.txt: stamps in seconds with nine decimals.
/// - kitti: sequences/00 with velodyne/000000.bin ... (x y z intensity, 0 where there is none),
///   times.txt (s since the first scan) and calib.txt (identity). No times of points.
/// - mcap: sensor_msgs/PointCloud2 on /points, frame "lidar", ROS 2 encoding, zstd, indexed; fields
///   as pcd.
enum class ScanFormat : std::uint8_t { pcd, kitti, mcap };

/// Throws Error(usage) for a name that is none of pcd, kitti, mcap.
ScanFormat scan_format_named(const std::string& name);

/// Throws Error(output) if something is there already.
std::unique_ptr<ScanWriter> open_scan_writer(const std::filesystem::path& path, ScanFormat format);

}  // namespace kissmap
