// SPDX-License-Identifier: MIT
#include "formats/datasets/dataset_folder.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <utility>

#include "formats/clouds/gather.hpp"
#include "formats/clouds/refusal.hpp"
#include "formats/clouds/scan_decoder.hpp"
#include "formats/datasets/datasets.hpp"
#include "formats/text/lower_case.hpp"
#include "formats/text/stamps.hpp"
#include "kissmap/error.hpp"

namespace kissmap {
namespace {

namespace fs = std::filesystem;

std::string prefix_of(const fs::path& root, const fs::path& folder) {
  const std::string relative = folder.lexically_relative(root).generic_string();
  return relative.empty() || relative == "." ? "" : relative + "/";
}

}  // namespace

std::unique_ptr<ScanLog> open_dataset(DatasetScans set, const ReadOptions& options) {
  require_valid(options);
  FolderContent content;
  content.info.format = set.format;
  content.info.path = set.path;
  content.info.sensor = set.sensor;
  content.info.stamp_source = set.stamp_source;
  content.info.notes = set.notes;
  content.scans =
      list_files(set.clouds, prefix_of(set.path, set.clouds), [&](const fs::path& file) {
        return lower_case(file.extension().string()) == set.extension;
      });
  if (content.scans.empty()) {
    throw input_error(set.clouds, std::string("has no ") + set.extension + " files");
  }
  for (ScanFile& scan : content.scans) scan.stamp_ns = set.stamp_of(scan.path);
  if (set.notes_of) {
    for (std::string& note : set.notes_of(content.scans)) {
      content.info.notes.push_back(std::move(note));
    }
  }
  const bool all_stamped =
      std::ranges::all_of(content.scans, [](const ScanFile& s) { return s.stamp_ns.has_value(); });
  if (all_stamped) std::ranges::stable_sort(content.scans, {}, &ScanFile::stamp_ns);
  std::vector<std::int64_t> stamps;
  for (const ScanFile& scan : content.scans) stamps.push_back(scan.stamp_ns.value_or(0));
  auto decoder = std::make_shared<ScanDecoder>(options);
  content.decode = [=, set = std::move(set)](std::span<const std::byte> bytes, std::size_t index) {
    if (bytes.empty()) throw Refusal(refusal_reason::empty, "the file has 0 bytes; copy it anew");
    Scan scan = decoder->decode(set.read(bytes, stamps[index]), stamps[index]);
    if (set.stamp_instant != StampInstant::unknown) scan.stamp_instant = set.stamp_instant;
    scan.compensation = set.compensation;
    if (set.derived_times && scan.time_source == TimeSource::recorded) {
      scan.time_source = TimeSource::derived;
    }
    return scan;
  };
  auto log = std::make_unique<FolderLog>(std::move(content));
  const LogEntry* first = log->peek();
  if (first != nullptr && std::holds_alternative<Scan>(first->content)) {
    log->add_note(decoder->time_note());
    log->set_fields(decoder->fields());
  }
  return log;
}

std::optional<std::int64_t> stamp_of_name(const fs::path& file) {
  return stamp_in_name(file.stem().string());
}

PointRecords packed_records(std::span<const std::byte> file,
                            std::vector<RecordField> fields,
                            std::size_t stride) {
  PointRecords records;
  records.layout.fields = std::move(fields);
  for (RecordField& field : records.layout.fields) field.stride = stride;
  records.count = file.size() / stride;
  records.bytes = file;
  return records;
}

PointRecords with_column(const PointRecords& records,
                         const std::string& name,
                         const std::vector<float>& values) {
  PointRecords more;
  more.layout = records.layout;
  more.layout.fields.push_back({name, ScalarType::f32, records.bytes.size(), sizeof(float), 1});
  more.count = records.count;
  std::vector<float> ordered = values;
  if (records.layout.byte_order != std::endian::native) {
    for (float& value : ordered) value = gather_detail::swapped(value);
  }
  const auto column = std::as_bytes(std::span(ordered));
  more.storage.reserve(records.bytes.size() + column.size());
  more.storage.assign(records.bytes.begin(), records.bytes.end());
  more.storage.insert(more.storage.end(), column.begin(), column.end());
  more.bytes = more.storage;
  return more;
}

std::vector<float> column_times(std::size_t points,
                                std::size_t rings,
                                std::size_t columns,
                                double period) {
  std::vector<float> times;
  if (points != rings * columns) return times;
  times.reserve(points);
  for (std::size_t i = 0; i < points; ++i) {
    const std::size_t column = i / rings;
    times.push_back(
        static_cast<float>(static_cast<double>(column) / static_cast<double>(columns) * period));
  }
  return times;
}

fs::path folder_of(const fs::path& path) {
  return fs::absolute(path / ".").lexically_normal().parent_path();
}

std::string mount_note(const std::string& frame, const Rigid3& frame_from_lidar) {
  const Eigen::Vector3d& t = frame_from_lidar.translation;
  const Eigen::Quaterniond& q = frame_from_lidar.rotation;
  std::string text = "the LiDAR (x,y,z,qx,qy,qz,qw) in " + frame + ": ";
  for (const double value : {t.x(), t.y(), t.z(), q.x(), q.y(), q.z(), q.w()}) {
    constexpr double step = 1e-9;  // what is smaller is rounding
    char number[40];
    std::snprintf(number, sizeof number, "%.9g,", step * std::round(value / step) + 0.0);
    text += number;
  }
  text.pop_back();
  return text;
}

bool has_stamped_files(const fs::path& folder, const char* extension) {
  std::error_code error;
  const fs::directory_iterator files(folder, error);
  if (error) return false;
  return std::any_of(begin(files), end(files), [&](const fs::directory_entry& entry) {
    return lower_case(entry.path().extension().string()) == extension &&
           stamp_of_name(entry.path()).has_value();
  });
}

bool probe_any_dataset(const fs::path& path) {
  return probe_mulran(path) || probe_helipr(path) || probe_apollo(path) || probe_nclt(path) ||
         probe_newer_college(path) || probe_boreas(path) || probe_paris_luco(path) ||
         probe_nuscenes(path) || probe_nclt_hits(path);
}

}  // namespace kissmap
