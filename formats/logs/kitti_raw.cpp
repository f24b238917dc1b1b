// SPDX-License-Identifier: MIT
// KITTI raw data: DATE_drive_NNNN_{sync,extract}/velodyne_points/{data/*.bin, timestamps*.txt}.
// Layout: readme.txt of the raw development kit (cvlibs.net/datasets/kitti), pykitti; times by
// azimuth: the loader of KISS-ICP.
#include <algorithm>
#include <charconv>
#include <utility>

#include "formats/clouds/cloud_file.hpp"
#include "formats/clouds/scan_decoder.hpp"
#include "formats/logs/folder_log.hpp"
#include "formats/logs/kitti_scans.hpp"
#include "formats/logs/logs.hpp"
#include "formats/logs/stamp_files.hpp"
#include "kissmap/error.hpp"

namespace kissmap {
namespace {

namespace fs = std::filesystem;

/// Begin and end of a sweep relative to its stamp [s].
struct Sweep {
  double start = -0.05;
  double end = 0.05;
};

bool is_bin(const fs::path& path) {
  return kind_by_name(path) == CloudKind::bin;
}

/// Stamps by line; scan N has line N + 1, also where files are missing.
struct Stamps {
  std::vector<std::optional<std::int64_t>> trigger, start, end;
};

std::vector<std::optional<std::int64_t>> read_if_there(const fs::path& folder,
                                                       const char* name,
                                                       FolderContent& content) {
  if (!fs::exists(folder / name)) return {};
  StampFile file = read_date_stamps(folder / name, std::string("velodyne_points/") + name);
  content.side_files.push_back(file.file);
  return std::move(file.stamps_ns);
}

template <class T>
std::optional<T> at(const std::vector<std::optional<T>>& values, std::size_t line) {
  return line < values.size() ? values[line] : std::nullopt;
}

Sweep sweep_of(const Stamps& stamps, std::size_t line) {
  const auto trigger = at(stamps.trigger, line);
  const auto start = at(stamps.start, line);
  const auto end = at(stamps.end, line);
  if (!trigger || !start || !end) return {};
  const Sweep sweep{static_cast<double>(*start - *trigger) * 1e-9,
                    static_cast<double>(*end - *trigger) * 1e-9};
  const bool sensible = sweep.start < sweep.end && sweep.start > -1.0 && sweep.end < 1.0;
  return sensible ? sweep : Sweep{};
}

std::size_t line_of(const ScanFile& scan) {
  const std::string stem = scan.path.stem().string();
  std::size_t number = 0;
  const char* end = stem.data() + stem.size();
  const auto [stop, error] = std::from_chars(stem.data(), end, number);
  if (error == std::errc() && stop == end) return number;
  throw input_error(scan.path, "the name is no scan number; KITTI raw has 0000000000.bin ...");
}

void derive_times(const Sweep& sweep, Scan& scan) {
  scan.time_offsets.reserve(scan.points.size());
  for (const Eigen::Vector3f& point : scan.points) {
    const double fraction = kitti_sweep_fraction(point);
    const double offset = sweep.start + fraction * (sweep.end - sweep.start);
    scan.time_offsets.push_back(static_cast<float>(offset));
  }
  scan.time_source = scan.points.empty() ? TimeSource::none : TimeSource::derived;
}

Scan decode_scan(std::span<const std::byte> bytes, std::int64_t stamp_ns) {
  ReadOptions without_times;
  without_times.time_unit = "none";
  Scan scan = ScanDecoder(without_times).decode(read_cloud(bytes, CloudKind::bin, 4), stamp_ns);
  scan.stamp_instant = StampInstant::sweep_middle;
  scan.compensation = Compensation::no;
  return scan;
}

void note_missing(const std::vector<std::size_t>& lines,
                  const Stamps& stamps,
                  FolderContent& content) {
  const std::size_t stamped = static_cast<std::size_t>(
      std::ranges::count_if(stamps.trigger, [](const auto& s) { return s.has_value(); }));
  if (stamped > lines.size()) {
    content.info.notes.push_back(std::to_string(stamped - lines.size()) +
                                 " scans that have a stamp are missing in data/");
  }
}

}  // namespace

bool probe_kitti_raw(const fs::path& path) {
  try {
    const fs::path folder = path / "velodyne_points";
    if (!fs::is_regular_file(folder / "timestamps.txt")) return false;
    const fs::directory_iterator entries(folder / "data");
    return std::any_of(
        begin(entries), end(entries), [](const auto& entry) { return is_bin(entry.path()); });
  } catch (const std::exception&) {
    return false;
  }
}

std::unique_ptr<ScanLog> open_kitti_raw(const fs::path& path, const ReadOptions& options) {
  require_valid(options);
  require_kitti_columns(options);
  const fs::path folder = path / "velodyne_points";
  FolderContent content;
  content.info.format = "kitti-raw";
  content.info.path = path;
  content.info.stamp_source = "timestamps.txt";
  content.scans = list_files(folder / "data", "velodyne_points/data/", is_bin);
  if (content.scans.empty()) throw input_error(folder / "data", "no .bin file in it");
  if (!fs::exists(folder / "timestamps.txt")) throw input_error(folder, "no timestamps.txt in it");

  const Stamps stamps{read_if_there(folder, "timestamps.txt", content),
                      read_if_there(folder, "timestamps_start.txt", content),
                      read_if_there(folder, "timestamps_end.txt", content)};
  std::vector<std::size_t> lines;
  for (ScanFile& scan : content.scans) {
    lines.push_back(line_of(scan));
    scan.stamp_ns = at(stamps.trigger, lines.back());
  }
  const bool with_times = options.time_unit != "none";
  content.info.notes.push_back(with_times
                                   ? "times of points follow from azimuth, clockwise from the rear"
                                   : "no times of points, as asked");
  if (with_times && (stamps.start.empty() || stamps.end.empty())) {
    content.info.notes.push_back("timestamps_start.txt or _end.txt is missing: sweeps of 0.1 s");
  }
  note_missing(lines, stamps, content);
  std::vector<std::int64_t> stamps_ns;
  for (const ScanFile& scan : content.scans) stamps_ns.push_back(scan.stamp_ns.value_or(0));
  content.decode = [=](std::span<const std::byte> bytes, std::size_t index) {
    Scan scan = decode_scan(bytes, stamps_ns[index]);
    if (with_times) derive_times(sweep_of(stamps, lines[index]), scan);
    return scan;
  };
  return std::make_unique<FolderLog>(std::move(content));
}

}  // namespace kissmap
