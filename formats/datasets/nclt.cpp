// SPDX-License-Identifier: MIT
// NCLT (Carlevaris-Bianco et al., IJRR 2016): velodyne_sync/<us>.bin with points of 8 bytes,
// unsigned 16-bit coordinates in steps of 5 mm from -100 m, x forward, y right, z down. Layout: the
// data set's read_vel_sync.py and bierschi/nclt2ros. The clouds are compensated for motion (an
// author of CT-ICP, its issue 28).
#include <cstring>

#include "formats/clouds/refusal.hpp"
#include "formats/datasets/dataset_folder.hpp"
#include "formats/datasets/datasets.hpp"

namespace kissmap {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t record_size = 8;
constexpr float step = 0.005F;    // m
constexpr float lowest = 100.0F;  // m below zero

constexpr std::size_t row_floats = 4;

// To x forward, y left, z up.
PointRecords read_scan(std::span<const std::byte> bytes, std::int64_t) {
  if (bytes.size() % record_size != 0) {
    throw Refusal(refusal_reason::wrong_size,
                  std::to_string(bytes.size()) + " bytes are no multiple of 8");
  }
  const std::size_t count = bytes.size() / record_size;
  std::vector<float> rows;
  rows.reserve(count * row_floats);
  for (std::size_t i = 0; i < count; ++i) {
    std::uint16_t raw[3];
    std::memcpy(raw, bytes.data() + i * record_size, sizeof(raw));
    rows.push_back(static_cast<float>(raw[0]) * step - lowest);
    rows.push_back(lowest - static_cast<float>(raw[1]) * step);
    rows.push_back(lowest - static_cast<float>(raw[2]) * step);
    rows.push_back(std::to_integer<std::uint8_t>(bytes[i * record_size + 6]));
  }
  PointRecords records;
  const auto stored = std::as_bytes(std::span(rows));
  records.storage.assign(stored.begin(), stored.end());
  records.bytes = records.storage;
  records.count = count;
  constexpr const char* names[] = {"x", "y", "z", "intensity"};
  for (std::size_t i = 0; i < row_floats; ++i) {
    records.layout.fields.push_back(
        {names[i], ScalarType::f32, i * sizeof(float), row_floats * sizeof(float), 1});
  }
  return records;
}

fs::path clouds_of(const fs::path& path) {
  std::error_code error;
  return fs::is_directory(path / "velodyne_sync", error) ? path / "velodyne_sync" : path;
}

}  // namespace

bool probe_nclt(const fs::path& path) {
  const fs::path clouds = clouds_of(path);
  const fs::path given = clouds.has_filename() ? clouds : clouds.parent_path();
  return given.filename() == "velodyne_sync" && has_stamped_files(given, ".bin");
}

std::unique_ptr<ScanLog> open_nclt(const fs::path& path, const ReadOptions& options) {
  DatasetScans set;
  set.format = "nclt";
  set.path = path;
  set.clouds = clouds_of(path);
  set.sensor = "Velodyne HDL-32E";
  set.notes = {"turned to x forward, y left, z up; compensated for motion already"};
  set.compensation = Compensation::yes;
  set.stamp_of = stamp_of_name;
  set.read = read_scan;
  return open_dataset(std::move(set), options);
}

}  // namespace kissmap
