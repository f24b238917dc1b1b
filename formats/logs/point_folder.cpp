// SPDX-License-Identifier: MIT
// A folder of cloud files with one scan each, or a single such file.
#include <algorithm>
#include <utility>

#include "formats/clouds/bin.hpp"
#include "formats/clouds/cloud_file.hpp"
#include "formats/clouds/refusal.hpp"
#include "formats/clouds/scan_decoder.hpp"
#include "formats/datasets/datasets.hpp"
#include "formats/files/input_file.hpp"
#include "formats/logs/cloud_folder.hpp"
#include "formats/logs/folder_log.hpp"
#include "formats/logs/logs.hpp"
#include "kissmap/error.hpp"

namespace kissmap {
namespace {

namespace fs = std::filesystem;

int find_bin_columns(FolderContent& content, const ReadOptions& options) {
  if (options.bin_columns != 0) return options.bin_columns;
  std::vector<std::uint64_t> sizes;
  for (const ScanFile& scan : content.scans) sizes.push_back(scan.size_bytes);
  const auto sample = std::ranges::find_if(sizes, [](auto size) { return size > 0; });
  std::vector<std::byte> bytes;
  try {
    if (sample != sizes.end()) {
      read_file(content.scans[static_cast<std::size_t>(sample - sizes.begin())].path, bytes);
    }
  } catch (const Refusal& refusal) {
    throw input_error(content.scans.front().path, refusal.what());
  }
  if (kind_by_content(bytes)) return 4;  // refused by name when its turn comes
  const auto columns = infer_bin_columns(sizes, bytes);
  if (const int* found = std::get_if<int>(&columns)) {
    content.info.notes.push_back(".bin read as rows of " + std::to_string(*found) + " float32");
    return *found;
  }
  throw input_error(
      content.info.path,
      "cannot tell how wide a row of the .bin files is: " + std::get<std::string>(columns) +
          "; say it with --bin-columns (KITTI has 4)");
}

std::unique_ptr<ScanLog> open_content(FolderContent content,
                                      CloudKind kind,
                                      const ReadOptions& options) {
  const int columns = kind == CloudKind::bin ? find_bin_columns(content, options) : 0;
  auto decoder = std::make_shared<ScanDecoder>(options);
  std::vector<std::int64_t> stamps;
  for (const ScanFile& scan : content.scans) stamps.push_back(*scan.stamp_ns);
  content.decode = [=](std::span<const std::byte> bytes, std::size_t index) {
    return decoder->decode(read_cloud(bytes, kind, columns), stamps[index]);
  };
  auto log = std::make_unique<FolderLog>(std::move(content));
  const LogEntry* first = log->peek();
  if (first != nullptr && std::holds_alternative<Scan>(first->content)) {
    log->add_note(decoder->time_note());
    log->set_fields(decoder->fields());
  }
  return log;
}

// A file of another name can still be a cloud; its content decides then.
std::optional<CloudKind> kind_of_file(const fs::path& path) {
  if (const auto kind = kind_by_name(path)) return kind;
  const auto content = kind_by_content(first_bytes(path, probe_size));
  if (content == "PCD") return CloudKind::pcd;
  if (content == "PLY") return CloudKind::ply;
  if (content == "NumPy array") return CloudKind::npy;
  if (content == "LAS file") return CloudKind::las;
  return std::nullopt;
}

// The first file speaks for the folder; one that cannot be recognised leaves it to the names.
bool first_cloud_is_foreign(const CloudFolder& folder) {
  const auto is_cloud = [](const fs::path& path) { return kind_by_name(path).has_value(); };
  const auto scans = list_files(folder.clouds, folder.prefix, is_cloud);
  if (scans.empty()) return true;
  const auto content = kind_by_content(first_bytes(scans[0].path, probe_size));
  return content && content != "PCD" && content != "PLY" && content != "NumPy array" &&
         content != "LAS file";
}

}  // namespace

bool probe_point_folder(const fs::path& path) {
  try {
    if (fs::is_regular_file(path)) {
      return kind_of_file(path).has_value() && !probe_any_dataset(path);
    }
    if (!fs::is_directory(path) || fs::exists(path / "session.json")) return false;
    if (probe_kitti_odometry(path) || probe_kitti_raw(path) || probe_any_dataset(path)) {
      return false;
    }
    const auto folders = find_cloud_folders(path);
    return !folders.empty() && !first_cloud_is_foreign(folders[0]);
  } catch (const std::exception&) {
    return false;
  }
}

std::unique_ptr<ScanLog> open_point_folder(const fs::path& path, const ReadOptions& options) {
  require_valid(options);
  FolderContent content;
  content.info.format = "folder";
  content.info.path = path;
  if (fs::is_directory(path)) {
    const CloudFolder folder = the_cloud_folder(path);
    content.scans = list_clouds(folder);
    find_stamps(folder, content);
    const CloudKind kind = *kind_by_name(content.scans.front().path);
    return open_content(std::move(content), kind, options);
  }
  const auto kind = kind_of_file(path);
  if (!kind)
    throw input_error(path,
                      "neither a folder nor a .pcd, .ply, .bin, .npy, .xyz, .csv or .las file");
  std::error_code no_size;
  const auto size = fs::file_size(path, no_size);
  content.scans = {{path, path.filename().string(), no_size ? 0 : size, std::nullopt}};
  find_stamp_of_single_file(content);
  return open_content(std::move(content), *kind, options);
}

}  // namespace kissmap
