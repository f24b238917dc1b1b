// SPDX-License-Identifier: MIT
// Newer College 2020 (Ramezani et al., IROS 2020): raw_format/ouster_scan/cloud_<sec>_<nsec>.pcd,
// OS1-64 clouds of 64 x 1024 points, column by column. Layout: the loaders of KISS-ICP and
// pyLiDAR-SLAM. Its recordings of 2021 are ROS 1 bags.
#include "formats/clouds/pcd.hpp"
#include "formats/datasets/dataset_folder.hpp"
#include "formats/datasets/datasets.hpp"
#include "kissmap/formats/trajectory_file.hpp"

namespace kissmap {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t rings = 64;
constexpr std::size_t columns = 1024;
constexpr double period = 0.1;  // s

PointRecords read_scan(std::span<const std::byte> bytes, std::int64_t) {
  PointRecords records = read_pcd(bytes);
  const std::vector<float> times = column_times(records.count, rings, columns, period);
  if (times.empty()) return records;
  return with_column(records, "time", times);
}

fs::path clouds_of(const fs::path& path) {
  std::error_code error;
  for (const char* inside : {"raw_format/ouster_scan", "ouster_scan"}) {
    if (fs::is_directory(path / inside, error)) return path / inside;
  }
  return path;
}

}  // namespace

bool probe_newer_college(const fs::path& path) {
  const fs::path clouds = clouds_of(path);
  const fs::path given = clouds.has_filename() ? clouds : clouds.parent_path();
  return given.filename() == "ouster_scan" && has_stamped_files(given, ".pcd");
}

std::unique_ptr<ScanLog> open_newer_college(const fs::path& path, const ReadOptions& options) {
  DatasetScans set;
  set.format = "newer-college";
  set.path = path;
  set.clouds = clouds_of(path);
  set.extension = ".pcd";
  set.sensor = "Ouster OS1-64";
  set.notes = {
      "times follow from the columns of whole scans, 64 x 1024 points in 0.1 s",
      mount_note("the left camera, whose poses are the truth", mount_from("newer-college-2020"))};
  set.compensation = Compensation::no;
  set.derived_times = true;
  set.stamp_of = stamp_of_name;
  set.read = read_scan;
  return open_dataset(std::move(set), options);
}

}  // namespace kissmap
