// SPDX-License-Identifier: MIT
// HeLiPR (Jung et al., IJRR 2024): four LiDARs, packed records, named by the stamp in ns. Layout:
// minwoo0611/HeLiPR-File-Player and HeLiPR-Pointcloud-Toolbox.
#include <algorithm>
#include <array>

#include "formats/clouds/refusal.hpp"
#include "formats/datasets/dataset_folder.hpp"
#include "formats/datasets/datasets.hpp"
#include "kissmap/error.hpp"

namespace kissmap {
namespace {

namespace fs = std::filesystem;

struct Sensor {
  const char* folder;
  const char* name;
};
constexpr std::array sensors{Sensor{"Ouster", "Ouster OS2-128"},
                             Sensor{"Velodyne", "Velodyne VLP-16"},
                             Sensor{"Avia", "Livox Avia"},
                             Sensor{"Aeva", "Aeva Aeries II"}};

std::vector<RecordField> xyz_and(std::vector<RecordField> more) {
  std::vector<RecordField> fields{{"x", ScalarType::f32, 0, 0, 1},
                                  {"y", ScalarType::f32, 4, 0, 1},
                                  {"z", ScalarType::f32, 8, 0, 1}};
  fields.insert(fields.end(), more.begin(), more.end());
  return fields;
}

PointRecords read_ouster(std::span<const std::byte> bytes, std::int64_t) {
  return packed_records(bytes,
                        xyz_and({{"intensity", ScalarType::f32, 12, 0, 1},
                                 {"t", ScalarType::u32, 16, 0, 1},
                                 {"reflectivity", ScalarType::u16, 20, 0, 1},
                                 {"ring", ScalarType::u16, 22, 0, 1},
                                 {"ambient", ScalarType::u16, 24, 0, 1}}),
                        26);
}

PointRecords read_velodyne(std::span<const std::byte> bytes, std::int64_t) {
  return packed_records(bytes,
                        xyz_and({{"intensity", ScalarType::f32, 12, 0, 1},
                                 {"ring", ScalarType::u16, 16, 0, 1},
                                 {"time", ScalarType::f32, 18, 0, 1}}),
                        22);
}

PointRecords read_avia(std::span<const std::byte> bytes, std::int64_t) {
  return packed_records(bytes,
                        xyz_and({{"reflectivity", ScalarType::u8, 12, 0, 1},
                                 {"tag", ScalarType::u8, 13, 0, 1},
                                 {"line", ScalarType::u8, 14, 0, 1},
                                 {"offset_time", ScalarType::u32, 15, 0, 1}}),
                        19);
}

/// Up to this stamp records lack their last number, the intensity.
constexpr std::int64_t last_short_stamp_ns = 1691936557946849179;
constexpr std::size_t short_size = 25;
constexpr std::size_t long_size = 29;

std::size_t size_by_stamp(std::int64_t stamp_ns) {
  return stamp_ns <= last_short_stamp_ns ? short_size : long_size;
}

/// The other size is taken where it alone divides the file.
bool is_swapped(std::uint64_t bytes, std::int64_t stamp_ns) {
  const std::size_t size = size_by_stamp(stamp_ns);
  return bytes % size != 0 && bytes % (short_size + long_size - size) == 0;
}

std::vector<std::string> aeva_notes(const std::vector<ScanFile>& files) {
  const auto swapped = [](const ScanFile& file) {
    return file.stamp_ns && is_swapped(file.size_bytes, *file.stamp_ns);
  };
  const auto count = std::ranges::count_if(files, swapped);
  if (count == 0) return {};
  return {"take care: " + std::to_string(count) + " of " + std::to_string(files.size()) +
          " files are no whole number of records of the size their stamp tells, but one of the "
          "other size (25 or 29 bytes), which is taken; the first is " +
          std::ranges::find_if(files, swapped)->name};
}

PointRecords read_aeva(std::span<const std::byte> bytes, std::int64_t stamp_ns) {
  const std::size_t usual = size_by_stamp(stamp_ns);
  const bool swapped = is_swapped(bytes.size(), stamp_ns);
  const std::size_t size = swapped ? short_size + long_size - usual : usual;
  return packed_records(bytes,
                        xyz_and({{"reflectivity", ScalarType::f32, 12, 0, 1},
                                 {"velocity", ScalarType::f32, 16, 0, 1},
                                 {"time_offset_ns", ScalarType::i32, 20, 0, 1},
                                 {"line_index", ScalarType::u8, 24, 0, 1}}),
                        size);
}

using Reader = PointRecords (*)(std::span<const std::byte>, std::int64_t);
constexpr std::array<Reader, sensors.size()> readers{
    read_ouster, read_velodyne, read_avia, read_aeva};

/// The folders of sensors a path stands for: itself, or those in it or in its LiDAR/.
std::vector<std::pair<fs::path, std::size_t>> sensor_folders(const fs::path& path) {
  const fs::path given = path.has_filename() ? path : path.parent_path();
  std::vector<std::pair<fs::path, std::size_t>> found;
  for (std::size_t i = 0; i < sensors.size(); ++i) {
    const bool itself =
        given.filename() == sensors[i].folder && given.parent_path().filename() == "LiDAR";
    const fs::path inside = given / "LiDAR" / sensors[i].folder;
    if (itself && has_stamped_files(given, ".bin")) return {{given, i}};
    if (has_stamped_files(inside, ".bin")) found.emplace_back(inside, i);
  }
  return found;
}

}  // namespace

bool probe_helipr(const fs::path& path) {
  return !sensor_folders(path).empty();
}

std::unique_ptr<ScanLog> open_helipr(const fs::path& path, const ReadOptions& options) {
  const auto folders = sensor_folders(path);
  if (folders.empty()) {
    throw input_error(path, "no LiDAR/Ouster, Velodyne, Avia or Aeva with <ns>.bin files in it");
  }
  if (folders.size() > 1) {
    std::string list;
    for (const auto& [folder, sensor] : folders) list += "\n  " + folder.string();
    throw input_error(path, "holds several sensors; give the folder of one:" + list);
  }
  const auto& [folder, sensor] = folders.front();
  DatasetScans set;
  set.format = "helipr";
  set.path = path;
  set.clouds = folder;
  set.sensor = sensors[sensor].name;
  set.compensation = Compensation::no;
  set.stamp_of = stamp_of_name;
  set.read = readers[sensor];
  if (readers[sensor] == read_aeva) set.notes_of = aeva_notes;
  return open_dataset(std::move(set), options);
}

}  // namespace kissmap
