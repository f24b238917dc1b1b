// SPDX-License-Identifier: MIT
// Apollo-SouthBay (Lu et al., CVPR 2019): pcds/<k>.pcd from 1 on, poses/gt_poses.txt with rows of
// index, stamp and pose. Layout: the loaders of KISS-ICP and PIN-SLAM. Whether the clouds are
// compensated for motion is not documented; they hold no times.
#include <charconv>
#include <map>

#include "formats/clouds/pcd.hpp"
#include "formats/datasets/dataset_folder.hpp"
#include "formats/datasets/datasets.hpp"
#include "formats/files/input_file.hpp"
#include "formats/text/lines.hpp"
#include "formats/text/stamps.hpp"
#include "kissmap/error.hpp"

namespace kissmap {
namespace {

namespace fs = std::filesystem;

std::optional<std::uint64_t> index_of(std::string_view text) {
  std::uint64_t index = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), index);
  if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return index;
}

std::map<std::uint64_t, std::int64_t> read_stamps(const fs::path& poses) {
  const std::vector<std::byte> bytes = read_side_file(poses);
  std::map<std::uint64_t, std::int64_t> stamps;
  Lines lines(text_of(bytes));
  while (const auto line = lines.next_not_blank()) {
    std::string_view rest = trimmed(*line);
    const std::size_t first = rest.find_first_of(" \t");
    if (first == std::string_view::npos) continue;
    const auto index = index_of(rest.substr(0, first));
    rest = trimmed(rest.substr(first));
    const auto stamp = nanoseconds_from_seconds(rest.substr(0, rest.find_first_of(" \t")));
    if (!index || !stamp) {
      throw input_error(
          poses,
          "line " + std::to_string(lines.number()) + " does not begin with an index and a stamp");
    }
    stamps[*index] = *stamp;
  }
  return stamps;
}

}  // namespace

bool probe_apollo(const fs::path& path) {
  std::error_code error;
  return fs::is_directory(path / "pcds", error) &&
         fs::is_regular_file(path / "poses" / "gt_poses.txt", error);
}

std::unique_ptr<ScanLog> open_apollo(const fs::path& path, const ReadOptions& options) {
  DatasetScans set;
  set.format = "apollo";
  set.path = path;
  set.clouds = path / "pcds";
  set.extension = ".pcd";
  set.sensor = "Velodyne HDL-64E S3";
  set.stamp_source = "poses/gt_poses.txt";
  set.stamp_of = [stamps = read_stamps(path / "poses" / "gt_poses.txt")](const fs::path& file) {
    const auto index = index_of(file.stem().string());
    const auto found = index ? stamps.find(*index) : stamps.end();
    return found == stamps.end() ? std::nullopt : std::optional(found->second);
  };
  set.read = [](std::span<const std::byte> bytes, std::int64_t) { return read_pcd(bytes); };
  return open_dataset(std::move(set), options);
}

}  // namespace kissmap
