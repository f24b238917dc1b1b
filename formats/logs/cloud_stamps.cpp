// SPDX-License-Identifier: MIT
#include <algorithm>

#include "formats/logs/cloud_folder.hpp"
#include "formats/logs/stamp_files.hpp"
#include "formats/text/lines.hpp"
#include "formats/text/stamps.hpp"
#include "kissmap/error.hpp"

namespace kissmap {
namespace {

namespace fs = std::filesystem;

/// Takes stamps from the names if all have one. A name that does not fit among names that do is
/// an error: it would end up anywhere in the order.
bool stamp_by_names(const CloudFolder& folder, std::vector<ScanFile>& scans) {
  const ScanFile* misfit = nullptr;
  for (ScanFile& scan : scans) {
    scan.stamp_ns = stamp_in_name(scan.path.stem().string());
    if (!scan.stamp_ns) misfit = &scan;
  }
  const auto stamped = static_cast<std::size_t>(
      std::ranges::count_if(scans, [](const ScanFile& scan) { return scan.stamp_ns.has_value(); }));
  if (stamped == 0) return false;
  if (misfit != nullptr) {
    throw input_error(folder.clouds,
                      std::to_string(stamped) + " names are stamps, " +
                          in_quotes(misfit->path.filename().string()) +
                          " is not; is it a copy? Move it away");
  }
  std::ranges::stable_sort(scans, {}, &ScanFile::stamp_ns);
  return true;
}

std::optional<StampFile> find_stamp_file(const CloudFolder& folder) {
  for (const char* name : {"times.txt", "timestamps.txt"}) {
    if (fs::exists(folder.root / name)) return read_number_stamps(folder.root / name, name);
    if (fs::exists(folder.clouds / name)) {
      return read_number_stamps(folder.clouds / name, folder.prefix + name);
    }
  }
  return std::nullopt;
}

void stamp_by_file(const StampFile& stamps, const CloudFolder& folder, FolderContent& content) {
  if (stamps.stamps_ns.size() != content.scans.size()) {
    throw input_error(folder.root / stamps.file.name,
                      std::to_string(stamps.stamps_ns.size()) + " stamps for " +
                          std::to_string(content.scans.size()) + " scans; each scan needs one");
  }
  for (std::size_t i = 0; i < content.scans.size(); ++i) {
    content.scans[i].stamp_ns = stamps.stamps_ns[i];
  }
  content.side_files.push_back(stamps.file);
  content.info.stamp_source = fs::path(stamps.file.name).filename().string();
}

void stamp_by_index(FolderContent& content) {
  for (std::size_t i = 0; i < content.scans.size(); ++i) {
    content.scans[i].stamp_ns = static_cast<std::int64_t>(i) * 1'000'000'000;
  }
  content.info.stamp_source = "index";
  content.stamps_are_indices = true;
  content.info.notes.push_back(
      "neither names nor a times.txt give stamps: scans are counted, one second each");
}

}  // namespace

void find_stamps(const CloudFolder& folder, FolderContent& content) {
  if (stamp_by_names(folder, content.scans)) {
    content.info.stamp_source = "file names";
  } else if (const auto stamps = find_stamp_file(folder)) {
    stamp_by_file(*stamps, folder, content);
  } else {
    stamp_by_index(content);
  }
}

void find_stamp_of_single_file(FolderContent& content) {
  ScanFile& scan = content.scans.at(0);
  scan.stamp_ns = stamp_in_name(scan.path.stem().string());
  if (scan.stamp_ns) {
    content.info.stamp_source = "file names";
  } else {
    stamp_by_index(content);
  }
}

}  // namespace kissmap
