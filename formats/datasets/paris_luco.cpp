// SPDX-License-Identifier: MIT
// Paris-Luco (Dellenbach et al., CT-ICP, ICRA 2022): frames/frame_%05d.ply with a time for each
// point, gt_traj_lidar.txt beside. Layout: mola_input_paris_luco_dataset, CT-ICP.
#include <charconv>

#include "formats/clouds/ply.hpp"
#include "formats/datasets/dataset_folder.hpp"
#include "formats/datasets/datasets.hpp"

namespace kissmap {
namespace {

namespace fs = std::filesystem;

constexpr std::int64_t period_ns = 100'000'000;
constexpr std::string_view prefix = "frame_";

std::optional<std::int64_t> stamp_of_frame(const fs::path& file) {
  const std::string stem = file.stem().string();
  if (!stem.starts_with(prefix)) return std::nullopt;
  std::int64_t number = 0;
  const char* end = stem.data() + stem.size();
  const auto [stop, error] = std::from_chars(stem.data() + prefix.size(), end, number);
  if (error != std::errc() || stop != end || number > 1'000'000'000) return std::nullopt;
  return number * period_ns;
}

}  // namespace

bool probe_paris_luco(const fs::path& path) {
  std::error_code error;
  return fs::is_regular_file(path / "gt_traj_lidar.txt", error) &&
         fs::is_directory(path / "frames", error);
}

std::unique_ptr<ScanLog> open_paris_luco(const fs::path& path, const ReadOptions& options) {
  DatasetScans set;
  set.format = "paris-luco";
  set.path = path;
  set.clouds = path / "frames";
  set.extension = ".ply";
  set.sensor = "Velodyne HDL-32E";
  set.stamp_source = "frame numbers, 0.1 s each";
  set.compensation = Compensation::no;
  set.stamp_of = stamp_of_frame;
  set.read = [](std::span<const std::byte> bytes, std::int64_t) { return read_ply(bytes); };
  return open_dataset(std::move(set), options);
}

}  // namespace kissmap
