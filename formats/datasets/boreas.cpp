// SPDX-License-Identifier: MIT
// Boreas and Boreas-RT (Burnett et al., IJRR 2023): VLS-128 rows of six float32 named by the middle
// of the sweep in us, times relative to it; Aeva records of 40 bytes named by the start. Layout:
// utiasASRL/pyboreas, DATA_REFERENCE.md and DATA_RT_REFERENCE.md.
#include <stdexcept>

#include "formats/clouds/bin.hpp"
#include "formats/datasets/dataset_folder.hpp"
#include "formats/datasets/datasets.hpp"
#include "formats/files/input_file.hpp"
#include "formats/text/lines.hpp"
#include "formats/trajectories/pose_fields.hpp"
#include "kissmap/error.hpp"

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

bool is_described(const fs::path& sequence) {
  std::error_code error;
  return fs::exists(sequence / "applanix", error) || fs::exists(sequence / "calib", error);
}

constexpr const char* lidars[] = {"lidar", "aeva"};

/// A folder of scans, and the sequence around it.
struct Clouds {
  fs::path folder;
  fs::path sequence;
  std::string lidar;
};

/// Those a path stands for: itself, or those in it.
std::vector<Clouds> clouds_of(const fs::path& path) {
  const fs::path given = folder_of(path);
  std::vector<Clouds> found;
  for (const char* lidar : lidars) {
    const bool itself = given.filename() == lidar && is_described(given.parent_path());
    if (itself && has_stamped_files(path, ".bin")) return {{path, given.parent_path(), lidar}};
    if (is_described(path) && has_stamped_files(path / lidar, ".bin")) {
      found.push_back({path / lidar, path, lidar});
    }
  }
  return found;
}

Clouds the_clouds(const fs::path& path, const std::string& wanted) {
  const std::vector<Clouds> found = clouds_of(path);
  if (found.empty()) {
    throw input_error(path, "no lidar/ or aeva/ with <us>.bin files beside an applanix/ or calib/");
  }
  std::string list;
  for (const Clouds& clouds : found) {
    if (clouds.lidar == wanted) return clouds;
    list += "\n  " + clouds.lidar;
  }
  if (!wanted.empty()) {
    throw usage_error("--topic " + wanted + ": no such lidar in " + path.string() +
                      "; lidars:" + list);
  }
  if (found.size() == 1) return found.front();
  throw input_error(path, "holds several lidars; choose one with --topic:" + list);
}

/// The file of a session's calibration: four rows of four numbers.
std::optional<Rigid3> read_matrix(const fs::path& file) {
  std::error_code error;
  if (!fs::is_regular_file(file, error)) return std::nullopt;
  const std::vector<std::byte> bytes = read_side_file(file);
  try {
    const Fields numbers = split_at_spaces(text_of(bytes));
    require_columns(numbers, 16, 16);
    return pose_of_rows(numbers);
  } catch (const std::invalid_argument&) {
    return std::nullopt;  // nothing depends on it
  }
}

std::vector<std::string> notes_for(const Clouds& clouds) {
  const fs::path calib = clouds.sequence / "calib";
  const auto applanix_from_lidar = read_matrix(calib / "T_applanix_lidar.txt");
  if (!applanix_from_lidar) return {};
  const std::string frame = "the frame of the Applanix, by calib/T_applanix_lidar.txt";
  if (clouds.lidar == "lidar") return {mount_note(frame, *applanix_from_lidar)};
  const auto aeva_from_lidar = read_matrix(calib / "T_aeva_lidar.txt");
  if (!aeva_from_lidar) return {};
  return {mount_note(frame + " and T_aeva_lidar.txt",
                     *applanix_from_lidar * aeva_from_lidar->inverse())};
}

}  // namespace

bool probe_boreas(const fs::path& path) {
  return !clouds_of(path).empty();
}

std::unique_ptr<ScanLog> open_boreas(const fs::path& path, const ReadOptions& options) {
  const Clouds clouds = the_clouds(path, options.topic);
  DatasetScans set;
  set.format = "boreas";
  set.path = path;
  set.clouds = clouds.folder;
  set.notes = notes_for(clouds);
  const bool spinning = clouds.lidar == "lidar";
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
