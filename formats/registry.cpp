// SPDX-License-Identifier: MIT
#include "kissmap/formats/registry.hpp"

#include <algorithm>
#include <string_view>
#include <vector>

#include "formats/clouds/cloud_file.hpp"
#include "formats/datasets/datasets.hpp"
#include "formats/files/input_file.hpp"
#include "formats/logs/logs.hpp"
#include "formats/session/pack_log.hpp"
#include "formats/text/lower_case.hpp"
#include "kissmap/error.hpp"
#include "kissmap/formats/pack.hpp"
#include "kissmap/formats/session.hpp"

namespace kissmap {
namespace {

constexpr LogFormat formats[] = {
    {"kitti",
     "KITTI odometry and SemanticKITTI sequences",
     "sequences/NN/ with velodyne/*.bin, times.txt, calib.txt, or its velodyne/",
     probe_kitti_odometry,
     open_kitti_odometry},
    {"kitti-raw",
     "KITTI raw drives, point times from azimuth",
     "DATE_drive_NNNN_sync/ with velodyne_points/data/*.bin and timestamps.txt",
     probe_kitti_raw,
     open_kitti_raw},
    {"mulran",
     "MulRan, times from columns",
     "a sequence with Ouster/<ns>.bin beside global_pose.csv, or that folder",
     probe_mulran,
     open_mulran},
    {"helipr",
     "HeLiPR: Ouster, Velodyne, Avia, Aeva",
     "a sequence with one LiDAR/SENSOR/<ns>.bin, or that folder of a sensor",
     probe_helipr,
     open_helipr},
    {"apollo",
     "Apollo-SouthBay",
     "a drive with pcds/<k>.pcd and poses/gt_poses.txt",
     probe_apollo,
     open_apollo},
    {"nclt",
     "NCLT, synchronised clouds",
     "a date with velodyne_sync/<us>.bin, or that folder",
     probe_nclt,
     open_nclt},
    {"nclt-hits",
     "NCLT, the raw stream",
     "a file velodyne_hits.bin",
     probe_nclt_hits,
     open_nclt_hits},
    {"newer-college",
     "Newer College 2020, times from columns",
     "an experiment with raw_format/ouster_scan/cloud_<sec>_<nsec>.pcd, or that folder",
     probe_newer_college,
     open_newer_college},
    {"boreas",
     "Boreas and Boreas-RT",
     "a sequence with lidar/<us>.bin or aeva/<us>.bin, applanix/, calib/, or one of the two",
     probe_boreas,
     open_boreas},
    {"paris-luco",
     "Paris-Luco, times recorded",
     "a sequence with frames/frame_NNNNN.ply and gt_traj_lidar.txt",
     probe_paris_luco,
     open_paris_luco},
    {"nuscenes",
     "nuScenes, one scene; --topic scene-NNNN chooses it",
     "the root with v1.0-mini, v1.0-trainval or v1.0-test, or one of these",
     probe_nuscenes,
     open_nuscenes},
    {"folder",
     "one .pcd, .ply, .bin, .npy, .xyz, .csv or .las file a scan",
     "a folder of such files, or one with a subfolder of them; times.txt beside; or one file",
     probe_point_folder,
     open_point_folder},
    {"rosbag",
     "ROS 1 bags: PointCloud2, Livox CustomMsg, packets of sensors",
     "a .bag file, or a folder with the .bag files of one recording",
     probe_ros1_bag,
     open_ros1_bag_log},
    {"rosbag2",
     "ROS 2 bags of the same, sqlite3 and MCAP storage, also packed with zstd",
     "the bag's folder, with metadata.yaml or without, or a .db3 file",
     probe_ros2_bag,
     open_ros2_bag_log},
    {"mcap",
     "MCAP files of the same, and of foxglove.PointCloud",
     "a .mcap file",
     probe_mcap,
     open_mcap_log},
    {"pcap",
     "packet captures of Velodyne, Hesai and Ouster sensors",
     "a pcap or pcapng file, an Ouster's metadata JSON beside it; --calibration for an HDL-64E",
     probe_capture,
     open_capture},
    {"lvx", "Livox Viewer's LVX 1.0 and 1.1", "a .lvx file", probe_lvx, open_lvx},
    {packed_format_name,
     "scans stored by `kissmap run --pack` or `kissmap pack`",
     "a session folder with packed_log.kmpack, or that file",
     probe_packed,
     open_packed},
};

std::string listed(const std::vector<const LogFormat*>& some) {
  std::string text;
  for (const LogFormat* format : some) {
    text += std::string("\n  ") + format->name + ": " + format->layout;
  }
  return text;
}

std::vector<const LogFormat*> all_formats() {
  std::vector<const LogFormat*> all;
  for (const LogFormat& format : formats) all.push_back(&format);
  return all;
}

const LogFormat& format_named(const std::string& name) {
  const auto* found = std::ranges::find(formats, std::string_view(name), &LogFormat::name);
  if (found == std::end(formats)) {
    throw usage_error("--format: there is no format '" + name +
                      "'; known are:" + listed(all_formats()));
  }
  return *found;
}

// What a file or the first file of a folder is instead, where its content tells.
std::string foreign_kind(const std::filesystem::path& path) {
  std::filesystem::path file = path;
  std::error_code error;
  for (const auto& entry : std::filesystem::directory_iterator(path, error)) {
    file = entry.path();
    if (kind_by_content(first_bytes(file, probe_size))) break;
  }
  const auto kind = kind_by_content(first_bytes(file, probe_size));
  if (kind == "LAS file" && lower_case(file.extension().string()) == ".laz") {
    return file.filename().string() +
           " is a compressed LAS file; unpack all, for example with 'pdal translate'; ";
  }
  return kind ? file.filename().string() + " is a " + *kind + "; " : "";
}

const LogFormat& format_of(const std::filesystem::path& path) {
  std::vector<const LogFormat*> fitting;
  for (const LogFormat& format : formats) {
    if (format.probe(path)) fitting.push_back(&format);
  }
  if (fitting.size() == 1) return *fitting[0];
  if (fitting.size() > 1) {
    throw input_error(path, "several formats fit; choose with --format:" + listed(fitting));
  }
  std::error_code error;
  if (std::filesystem::is_directory(path, error) && std::filesystem::is_empty(path, error)) {
    throw input_error(path, "an empty folder, no log; known are:" + listed(all_formats()));
  }
  if (is_session(path)) {
    throw input_error(path,
                      "a session whose scans are not stored inside, or whose " +
                          std::string(pack_file_name) +
                          " is damaged; give the log it was made from (see 'kissmap info'), or "
                          "make a pack with 'kissmap pack'");
  }
  if (std::filesystem::is_regular_file(path, error) && std::filesystem::is_empty(path, error)) {
    throw input_error(path, "has 0 bytes; copy it anew");
  }
  const std::filesystem::directory_iterator listing(path, error);
  if (error && error != std::errc::not_a_directory) {
    throw input_error(path, "cannot be listed: " + error.message());
  }
  throw input_error(
      path,
      "not a log kissmap can read; " + foreign_kind(path) + "known are:" + listed(all_formats()));
}

}  // namespace

std::span<const LogFormat> log_formats() {
  return formats;
}

std::unique_ptr<ScanLog> open_log(const std::filesystem::path& path,
                                  const ReadOptions& options,
                                  const std::string& format_name) {
  require_valid(options);
  const LogFormat* named = format_name.empty() ? nullptr : &format_named(format_name);
  std::error_code error;
  if (!std::filesystem::exists(path, error)) {
    throw input_error(path, error ? error.message() : "no such file or folder");
  }
  // Before any probe: opening a pipe would wait for a writer.
  if (!std::filesystem::is_directory(path, error) &&
      !std::filesystem::is_regular_file(path, error)) {
    throw input_error(path, "is neither a file nor a folder");
  }
  return (named != nullptr ? *named : format_of(path)).open(path, options);
}

}  // namespace kissmap
