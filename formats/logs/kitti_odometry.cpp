// SPDX-License-Identifier: MIT
// KITTI odometry and SemanticKITTI: sequences/NN/{velodyne/*.bin, times.txt, calib.txt}. Layout:
// readme.txt of the odometry development kit (cvlibs.net/datasets/kitti), the loaders of KISS-ICP
// and pykitti; SemanticKITTI: semantic-kitti-api. The correction of 0.205 degrees: KISS-ICP,
// CT-ICP.
#include <algorithm>
#include <charconv>
#include <functional>
#include <numeric>
#include <sstream>
#include <utility>

#include "formats/clouds/cloud_file.hpp"
#include "formats/clouds/scan_decoder.hpp"
#include "formats/logs/folder_log.hpp"
#include "formats/logs/kitti_calibration.hpp"
#include "formats/logs/kitti_scans.hpp"
#include "formats/logs/logs.hpp"
#include "formats/logs/stamp_files.hpp"
#include "kissmap/error.hpp"

namespace kissmap {
namespace {

namespace fs = std::filesystem;

constexpr std::int64_t scan_period_ns = 100'000'000;

bool is_bin(const fs::path& path) {
  return kind_by_name(path) == CloudKind::bin;
}

bool is_sequence(const fs::path& folder) {
  std::error_code error;
  for (const auto& entry : fs::directory_iterator(folder / "velodyne", error)) {
    if (is_bin(entry.path())) return true;
  }
  return false;
}

/// The sequences a path stands for: itself, the parent of its velodyne/, or those of a data set.
std::vector<fs::path> find_sequences(const fs::path& path) {
  if (is_sequence(path)) return {path};
  const fs::path folder = fs::absolute(path / ".").lexically_normal().parent_path();
  const fs::path parent = folder.parent_path();
  if (folder.filename() == "velodyne" && fs::exists(parent / "calib.txt") && is_sequence(parent)) {
    return {parent};
  }
  std::vector<fs::path> sequences;
  std::error_code error;
  for (const auto& entry : fs::directory_iterator(path / "sequences", error)) {
    if (is_sequence(entry.path())) sequences.push_back(entry.path());
  }
  std::ranges::sort(sequences);
  return sequences;
}

fs::path the_sequence(const fs::path& path) {
  const std::vector<fs::path> sequences = find_sequences(path);
  if (sequences.size() == 1) return sequences[0];
  if (sequences.empty()) throw input_error(path, "no velodyne/*.bin in it or in its sequences/*");
  std::string names;
  for (const fs::path& sequence : sequences) names.append(" ").append(sequence.filename());
  throw input_error(path / "sequences", "several sequences:" + names + "; name one of them");
}

/// The line of times.txt of each scan, which is the number in its name (KITTI counts from 0); so a
/// sequence may lack scans. Scans numbered otherwise take the lines in order if there are as many.
std::vector<std::size_t> stamp_lines(const std::vector<ScanFile>& scans, std::size_t stamps) {
  std::vector<std::size_t> lines;
  for (const ScanFile& scan : scans) {
    const std::string stem = scan.path.stem();
    std::size_t number = stamps;
    const auto [stop, error] = std::from_chars(stem.data(), stem.data() + stem.size(), number);
    if (error != std::errc() || stop != stem.data() + stem.size() || number >= stamps) break;
    lines.push_back(number);
  }
  const bool rising = std::ranges::adjacent_find(lines, std::greater_equal{}) == lines.end();
  if (rising && lines.size() == scans.size()) return lines;
  if (stamps != scans.size()) return {};
  lines.resize(stamps);
  std::iota(lines.begin(), lines.end(), std::size_t{0});
  return lines;
}

void stamp_scans(const fs::path& sequence, FolderContent& content) {
  if (!fs::exists(sequence / "times.txt")) {
    for (std::size_t i = 0; i < content.scans.size(); ++i) {
      content.scans[i].stamp_ns = static_cast<std::int64_t>(i) * scan_period_ns;
    }
    content.info.stamp_source = "index";
    content.stamps_are_indices = true;
    content.info.notes.push_back("no times.txt: scans are counted, 0.1 s each");
    return;
  }
  const StampFile stamps = read_number_stamps(sequence / "times.txt", "times.txt");
  const std::vector<std::size_t> lines = stamp_lines(content.scans, stamps.stamps_ns.size());
  if (lines.empty()) {
    throw input_error(sequence / "times.txt",
                      std::to_string(stamps.stamps_ns.size()) + " stamps for " +
                          std::to_string(content.scans.size()) +
                          " scans in velodyne/, and the names of the scans are not their lines");
  }
  for (std::size_t i = 0; i < content.scans.size(); ++i) {
    content.scans[i].stamp_ns = stamps.stamps_ns[lines[i]];
  }
  const std::size_t missing = stamps.stamps_ns.size() - content.scans.size();
  if (missing > 0) {
    content.info.notes.push_back("times.txt has " + std::to_string(missing) +
                                 " stamps without a scan");
  }
  content.side_files.push_back(stamps.file);
  content.info.stamp_source = "times.txt";
}

// Scans need no calibration, poses for the benchmark do: the user hears of it either way.
std::string calibration_note(const fs::path& sequence) {
  if (!fs::exists(sequence / "calib.txt")) return "no calib.txt: poses stay in the lidar frame";
  try {
    const Rigid3 cam0_from_lidar = read_kitti_cam0_from_lidar(sequence / "calib.txt");
    std::ostringstream text;
    text << "calib.txt: the lidar is at " << cam0_from_lidar.translation.transpose()
         << " m in camera 0";
    return text.str();
  } catch (const Error& error) {
    return std::string("calib.txt is of no use: ") + error.what();
  }
}

Scan decode_scan(std::span<const std::byte> bytes, std::int64_t stamp_ns, bool correct) {
  ReadOptions without_times;
  without_times.time_unit = "none";
  Scan scan = ScanDecoder(without_times).decode(read_cloud(bytes, CloudKind::bin, 4), stamp_ns);
  if (correct) {
    for (Eigen::Vector3f& point : scan.points) point = raised_by_kitti_correction(point);
  }
  // KITTI moved the points to the instant at which the cameras were triggered: facing forward.
  scan.stamp_instant = StampInstant::sweep_middle;
  scan.compensation = Compensation::yes;
  return scan;
}

}  // namespace

bool probe_kitti_odometry(const fs::path& path) {
  try {
    return fs::is_directory(path) && !find_sequences(path).empty();
  } catch (const std::exception&) {
    return false;
  }
}

std::unique_ptr<ScanLog> open_kitti_odometry(const fs::path& path, const ReadOptions& options) {
  require_valid(options);
  require_kitti_columns(options);
  const fs::path sequence = the_sequence(path);
  FolderContent content;
  content.info.format = "kitti";
  content.info.path = sequence;
  content.scans = list_files(sequence / "velodyne", "velodyne/", is_bin);
  stamp_scans(sequence, content);
  content.info.notes.push_back("points are motion-compensated already and have no times");
  content.info.notes.push_back(calibration_note(sequence));
  const bool correct = options.kitti_elevation_correction;
  content.info.notes.push_back(correct ? "points raised by 0.205 degrees (KITTI's calibration)"
                                       : "points not raised by 0.205 degrees, as asked");
  std::vector<std::int64_t> stamps;
  for (const ScanFile& scan : content.scans) stamps.push_back(*scan.stamp_ns);
  content.decode = [=](std::span<const std::byte> bytes, std::size_t index) {
    return decode_scan(bytes, stamps[index], correct);
  };
  return std::make_unique<FolderLog>(std::move(content));
}

}  // namespace kissmap
