// SPDX-License-Identifier: MIT
// Boreas and Boreas-RT (Burnett et al., IJRR 2023): VLS-128 rows of six float32 named by the middle
// of the sweep in us, times relative to it; Aeva records of 40 bytes named by the start. Layout:
// utiasASRL/pyboreas, DATA_REFERENCE.md and DATA_RT_REFERENCE.md.
#include "formats/clouds/bin.hpp"
#include "formats/datasets/dataset_folder.hpp"
#include "formats/datasets/datasets.hpp"

namespace kissmap {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t aeva_record = 40;  // bytes
constexpr int lidar_columns = 6;

PointRecords read_aeva(std::span<const std::byte> bytes, std::int64_t) {
  return packed_records(bytes,
                        {{"x", ScalarType::f32, 0, 0, 1},
                         {"y", ScalarType::f32, 4, 0, 1},
                         {"z", ScalarType::f32, 8, 0, 1},
                         {"velocity", ScalarType::f32, 12, 0, 1},
                         {"intensity", ScalarType::f32, 16, 0, 1},
                         {"quality", ScalarType::f32, 20, 0, 1},
                         {"reflectivity", ScalarType::f32, 24, 0, 1},
                         {"time", ScalarType::f32, 28, 0, 1}},
                        aeva_record);
}

bool is_described(const fs::path& path) {
  std::error_code error;
  return fs::exists(path / "applanix", error) || fs::exists(path / "calib", error);
}

/// The folder of scans; of two, the spinning sensor's.
fs::path clouds_of(const fs::path& path) {
  return has_stamped_files(path / "lidar", ".bin") ? path / "lidar" : path / "aeva";
}

}  // namespace

bool probe_boreas(const fs::path& path) {
  return is_described(path) && has_stamped_files(clouds_of(path), ".bin");
}

std::unique_ptr<ScanLog> open_boreas(const fs::path& path, const ReadOptions& options) {
  DatasetScans set;
  set.format = "boreas";
  set.path = path;
  set.clouds = clouds_of(path);
  const bool spinning = set.clouds.filename() == "lidar";
  set.sensor = spinning ? "Velodyne VLS-128" : "Aeva Aeries II";
  set.stamp_instant = spinning ? StampInstant::sweep_middle : StampInstant::sweep_start;
  set.compensation = Compensation::no;
  set.stamp_of = stamp_of_name;
  if (spinning) {
    set.read = [](std::span<const std::byte> bytes, std::int64_t) {
      return read_bin(bytes, lidar_columns);
    };
  } else {
    set.read = read_aeva;
  }
  return open_dataset(std::move(set), options);
}

}  // namespace kissmap
