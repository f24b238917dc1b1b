// SPDX-License-Identifier: MIT
#include "formats/session/trajectory_files.hpp"

#include "formats/session/session_folder.hpp"
#include "formats/trajectories/pose_lines.hpp"

namespace kissmap {

TrajectoryFiles::TrajectoryFiles(const std::filesystem::path& session)
    : tum_(session / tum_file_name), kitti_(session / kitti_file_name) {
  tum_.write(tum_header);
}

void TrajectoryFiles::add(std::int64_t pose_stamp_ns, const Rigid3& map_from_lidar) {
  tum_.write(tum_line(pose_stamp_ns, map_from_lidar));
  kitti_.write(kitti_line(map_from_lidar));
}

void TrajectoryFiles::close() {
  tum_.close();
  kitti_.close();
}

}  // namespace kissmap
