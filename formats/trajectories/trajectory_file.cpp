// SPDX-License-Identifier: MIT
#include "kissmap/formats/trajectory_file.hpp"

#include <optional>
#include <span>
#include <stdexcept>

#include "formats/datasets/nuscenes_tables.hpp"
#include "formats/files/input_file.hpp"
#include "formats/logs/kitti_calibration.hpp"
#include "formats/logs/stamp_files.hpp"
#include "formats/text/lines.hpp"
#include "formats/trajectories/dataset_poses.hpp"
#include "formats/trajectories/pose_reader.hpp"
#include "kissmap/error.hpp"
#include "kissmap/formats/session.hpp"

namespace kissmap {
namespace {

namespace fs = std::filesystem;

constexpr const char* known_layouts =
    "known are TUM (stamp x y z qx qy qz qw), KITTI (12 numbers), EuRoC (ns,x,y,z,qw,qx,qy,qz), "
    "positions (x y z or stamp x y z) and the ground truth of MulRan, HeLiPR, Boreas, NCLT, Newer "
    "College, Oxford Spires, Apollo-SouthBay, Paris-Luco and nuScenes (its folder)";

constexpr const char* nuscenes_format = "nuScenes";

std::string at_line(std::size_t line) {
  return "line " + std::to_string(line) + ": ";
}

TrajectoryFile from_session(const fs::path& path) {
  TrajectoryFile file{{}, "session", 0};
  for (const SessionScan& scan : read_session(path).scans) {
    file.trajectory.stamps_ns.push_back(scan.mapped.pose_stamp_ns);
    file.trajectory.poses.push_back(scan.mapped.map_from_lidar);
  }
  return file;
}

TrajectoryFile from_nuscenes(const fs::path& path, const std::string& topic) {
  const fs::path tables = nuscenes_tables_of(path);
  const NuscenesScene scene = read_nuscenes_scene(tables, topic);
  if (scene.scans.empty()) throw input_error(tables, "the scene has no LIDAR_TOP files");
  TrajectoryFile file{{}, nuscenes_format, 0};
  file.trajectory.poses = read_nuscenes_poses(tables, scene);
  for (const NuscenesScan& scan : scene.scans) {
    file.trajectory.stamps_ns.push_back(scan.stamp_ns);
  }
  return file;
}

std::string_view without_byte_order_mark(std::string_view text) {
  constexpr std::string_view mark = "\xef\xbb\xbf";
  return text.starts_with(mark) ? text.substr(mark.size()) : text;
}

PoseLayout require_layout(std::string_view line, std::size_t number, const fs::path& path) {
  if (const auto layout = layout_of(line)) return *layout;
  throw input_error(
      path, at_line(number) + in_quotes(line) + " is no pose of a known layout; " + known_layouts);
}

void append_row(TrajectoryFile& file, const PoseRow& row) {
  Trajectory& trajectory = file.trajectory;
  if (row.stamp_ns.has_value() != trajectory.has_stamps() && trajectory.size() > 0) {
    throw std::invalid_argument("some lines have a stamp, others have none");
  }
  if (row.stamp_ns) {
    if (!trajectory.stamps_ns.empty()) {
      const std::int64_t last = trajectory.stamps_ns.back();
      if (*row.stamp_ns < last) {
        throw std::invalid_argument("the stamp is before that of the pose before; sort the lines");
      }
      file.repeated += *row.stamp_ns == last ? 1 : 0;
    }
    trajectory.stamps_ns.push_back(*row.stamp_ns);
  }
  trajectory.poses.push_back(row.pose);
}

TrajectoryFile from_text(const fs::path& path) {
  const std::vector<std::byte> bytes = read_side_file(path);
  TrajectoryFile file;
  std::optional<PoseLayout> layout;
  Lines lines(without_byte_order_mark(text_of(bytes)));
  while (const auto line = lines.next_not_blank()) {
    if (trimmed(*line).starts_with('#')) continue;
    if (!layout && is_column_names(*line)) continue;
    if (!layout) layout = require_layout(*line, lines.number(), path);
    if (is_unknown_pose(*line, *layout)) continue;
    try {
      append_row(file, read_pose_row(*line, *layout));
    } catch (const std::invalid_argument& problem) {
      throw input_error(path, at_line(lines.number()) + problem.what());
    }
  }
  if (!layout) throw input_error(path, std::string("holds no pose; ") + known_layouts);
  file.format = name_of(*layout);
  file.trajectory.positions_only = *layout == PoseLayout::positions;
  return file;
}

void add_stamps(Trajectory& trajectory, const fs::path& path, const fs::path& times) {
  const StampFile stamps = read_number_stamps(times, times.filename());
  if (stamps.stamps_ns.size() != trajectory.size()) {
    throw input_error(times,
                      std::to_string(stamps.stamps_ns.size()) + " stamps for the " +
                          std::to_string(trajectory.size()) + " poses of " + path.string() +
                          "; each pose needs one");
  }
  for (const auto& stamp : stamps.stamps_ns) {
    if (!trajectory.stamps_ns.empty() && *stamp <= trajectory.stamps_ns.back()) {
      throw input_error(times,
                        "stamp " + std::to_string(trajectory.stamps_ns.size() + 1) +
                            " is not after the one before; poses and stamps have to be in order");
    }
    trajectory.stamps_ns.push_back(*stamp);
  }
}

TrajectoryFile from_folder(const fs::path& path, const std::string& topic) {
  if (is_session(path)) return from_session(path);
  if (has_nuscenes_tables(path)) return from_nuscenes(path, topic);
  throw input_error(path, "is a folder but no session; name the file of a trajectory in it");
}

bool is_paris_luco(const fs::path& path, const Trajectory& trajectory) {
  return path.filename() == paris_luco_truth && trajectory.positions_only &&
         !trajectory.has_stamps();
}

}  // namespace

TrajectoryFile read_trajectory(const fs::path& path,
                               const fs::path& times,
                               const std::string& topic) {
  std::error_code ignored;  // what cannot be looked at cannot be opened either, which says why
  const bool folder = fs::is_directory(path, ignored);
  TrajectoryFile file = folder ? from_folder(path, topic) : from_text(path);
  if (!topic.empty() && file.format != nuscenes_format) {
    throw usage_error("--topic " + topic + ": " + path.string() + " has no scenes to choose from");
  }
  if (times.empty() && is_paris_luco(path, file.trajectory)) {
    file.format = "Paris-Luco";
    file.trajectory.stamps_ns = paris_luco_stamps(file.trajectory.size());
  }
  if (!times.empty() && !file.trajectory.has_stamps()) add_stamps(file.trajectory, path, times);
  try {
    require_valid(file.trajectory);
  } catch (const Error& error) {
    throw input_error(path, error.what());
  }
  return file;
}

Rigid3 read_kitti_calibration(const fs::path& calib_txt) {
  return read_kitti_cam0_from_lidar(calib_txt);
}

}  // namespace kissmap
