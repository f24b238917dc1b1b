// SPDX-License-Identifier: MIT
// MulRan (Kim et al., ICRA 2020): OS1-64 clouds of 64 x 1024 float32 rows, column by column, named
// by the stamp in ns. Layout: irapkaist/file_player_mulran, and its author's answers there (issues
// 1, 6, 16, 25).
#include "formats/datasets/dataset_folder.hpp"
#include "formats/datasets/datasets.hpp"
#include "formats/trajectories/dataset_poses.hpp"

namespace kissmap {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t rings = 64;
constexpr std::size_t columns = 1024;
constexpr double period = 0.1;  // s

bool is_described(const fs::path& sequence) {
  std::error_code error;
  return fs::exists(sequence / "global_pose.csv", error) ||
         fs::exists(sequence / "data_stamp.csv", error);
}

/// The folder of scans a path stands for: itself, or the one in it.
fs::path clouds_of(const fs::path& path) {
  const fs::path given = folder_of(path);
  std::error_code error;
  if (given.filename() == "Ouster") {
    const fs::path parent = given.parent_path();
    const bool of_player = parent.filename() == "sensor_data";
    return of_player || is_described(parent) ? path : fs::path();
  }
  const fs::path player = path / "sensor_data" / "Ouster";
  if (fs::is_directory(player, error)) return player;
  // HeLiPR's sequences have a folder LiDAR/.
  return is_described(path) && !fs::exists(path / "LiDAR", error) ? path / "Ouster" : fs::path();
}

// A scan that is not whole keeps its points, but nobody knows which columns are missing.
PointRecords read_scan(std::span<const std::byte> bytes, std::int64_t) {
  const PointRecords rows = packed_records(bytes,
                                           {{"x", ScalarType::f32, 0, 0, 1},
                                            {"y", ScalarType::f32, 4, 0, 1},
                                            {"z", ScalarType::f32, 8, 0, 1},
                                            {"intensity", ScalarType::f32, 12, 0, 1}},
                                           16);
  std::vector<float> times = column_times(rows.count, rings, columns, period);
  if (times.empty()) times.assign(rows.count, 0.0F);
  return with_column(rows, "time", times);
}

}  // namespace

bool probe_mulran(const fs::path& path) {
  const fs::path clouds = clouds_of(path);
  return !clouds.empty() && has_stamped_files(clouds, ".bin");
}

std::unique_ptr<ScanLog> open_mulran(const fs::path& path, const ReadOptions& options) {
  DatasetScans set;
  set.format = "mulran";
  set.path = path;
  set.clouds = clouds_of(path);
  // Where the user says what it is, nothing has to lie beside it.
  if (set.clouds.empty()) {
    set.clouds = folder_of(path).filename() == "Ouster" ? path : path / "Ouster";
  }
  set.sensor = "Ouster OS1-64";
  set.notes = {"times follow from the columns of whole scans, 64 x 1024 points in 0.1 s",
               mount_note("the vehicle's base, by its paper", mulran_base_from_lidar())};
  set.stamp_instant = StampInstant::unknown;  // not documented; a constant shift does no harm
  set.compensation = Compensation::no;
  set.derived_times = true;
  set.stamp_of = stamp_of_name;
  set.read = read_scan;
  return open_dataset(std::move(set), options);
}

}  // namespace kissmap
