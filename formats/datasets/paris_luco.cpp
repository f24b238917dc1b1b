// SPDX-License-Identifier: MIT
// Paris-Luco (Dellenbach et al., CT-ICP, ICRA 2022): frames/frame_%05d.ply with a time for each
// point, gt_traj_lidar.txt beside. Layout: mola_input_paris_luco_dataset, CT-ICP.
#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>

#include "formats/clouds/gather.hpp"
#include "formats/clouds/ply.hpp"
#include "formats/datasets/dataset_folder.hpp"
#include "formats/datasets/datasets.hpp"
#include "formats/trajectories/dataset_poses.hpp"

namespace kissmap {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view prefix = "frame_";

std::optional<std::int64_t> stamp_of_frame(const fs::path& file) {
  const std::string stem = file.stem().string();
  if (!stem.starts_with(prefix)) return std::nullopt;
  std::int64_t number = 0;
  const char* end = stem.data() + stem.size();
  const auto [stop, error] = std::from_chars(stem.data() + prefix.size(), end, number);
  if (error != std::errc() || stop != end || number > 1'000'000'000) return std::nullopt;
  return number * paris_luco_period_ns;
}

/// The column timestamp as seconds or whatever its unit is, from the first point on: only their
/// span is meant, and a sequence's first frames would pass for times relative to their stamps.
PointRecords from_first_point(PointRecords records) {
  const auto field = std::ranges::find(records.layout.fields, "timestamp", &RecordField::name);
  if (field == records.layout.fields.end() || records.count == 0) return records;
  const std::size_t last = field->offset + (records.count - 1) * field->stride;
  if (last + size_of(field->type) > records.bytes.size()) return records;  // refused later
  const std::byte* first = records.bytes.data() + field->offset;
  const bool wide = field->type == ScalarType::i64 || field->type == ScalarType::u64;
  const bool swap = records.layout.byte_order != std::endian::native;
  const std::int64_t base = wide ? gather_detail::load<std::int64_t>(first, swap) : 0;
  std::vector<double> times(records.count);
  gather_for<double>(field->type, records.layout.byte_order)(
      first, field->stride, records.count, base, times.data());
  double earliest = std::numeric_limits<double>::infinity();
  for (const double time : times) {
    if (std::isfinite(time)) earliest = std::min(earliest, time);
  }
  std::vector<float> since;
  since.reserve(times.size());
  for (const double time : times) since.push_back(static_cast<float>(time - earliest));
  return with_column(records, "time", since);
}

}  // namespace

bool probe_paris_luco(const fs::path& path) {
  std::error_code error;
  return fs::is_regular_file(path / paris_luco_truth, error) &&
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
  set.read = [](std::span<const std::byte> bytes, std::int64_t) {
    return from_first_point(read_ply(bytes));
  };
  return open_dataset(std::move(set), options);
}

}  // namespace kissmap
