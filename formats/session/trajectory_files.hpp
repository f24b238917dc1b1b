// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <filesystem>

#include "formats/files/output_file.hpp"
#include "kissmap/geometry/rigid3.hpp"

namespace kissmap {

/// trajectory.tum and trajectory_kitti.txt of a session, as the scans come.
/// Throws Error(output).
class TrajectoryFiles {
 public:
  explicit TrajectoryFiles(const std::filesystem::path& session);
  void add(std::int64_t pose_stamp_ns, const Rigid3& map_from_lidar);
  void close();  ///< flushes both to the disk

 private:
  OutputFile tum_;
  OutputFile kitti_;
};

}  // namespace kissmap
