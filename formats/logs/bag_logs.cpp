// SPDX-License-Identifier: MIT
// Logs that are containers of messages: ROS bags and MCAP files.
#include <algorithm>

#include "formats/clouds/cloud_file.hpp"
#include "formats/containers/joined_source.hpp"
#include "formats/containers/mcap.hpp"
#include "formats/containers/ros1_bag.hpp"
#include "formats/containers/ros2_bag.hpp"
#include "formats/files/input_file.hpp"
#include "formats/logs/logs.hpp"
#include "formats/logs/message_log.hpp"
#include "formats/text/lower_case.hpp"
#include "formats/text/stamps.hpp"
#include "kissmap/error.hpp"

namespace kissmap {
namespace {

namespace fs = std::filesystem;

bool has_extension(const fs::path& path, const char* extension) {
  return lower_case(path.extension().string()) == extension;
}

bool is_kind(const fs::path& file, const char* kind) {
  return kind_by_content(first_bytes(file, probe_size)) == kind;
}

std::vector<fs::path> files_with(const fs::path& folder, const char* extension) {
  std::vector<fs::path> files;
  std::error_code unreadable;
  for (const auto& entry : fs::directory_iterator(folder, unreadable)) {
    if (has_extension(entry.path(), extension)) files.push_back(entry.path());
  }
  std::ranges::sort(files, natural_less, [](const fs::path& p) { return p.filename().string(); });
  return files;
}

std::unique_ptr<ScanLog> log_of(std::unique_ptr<MessageSource> source,
                                const char* format,
                                const fs::path& path,
                                const ReadOptions& options) {
  LogInfo info;
  info.format = format;
  info.path = path;
  return open_message_log(std::move(source), std::move(info), options);
}

}  // namespace

bool probe_ros1_bag(const fs::path& path) {
  std::error_code error;
  if (!fs::is_directory(path, error)) return is_kind(path, "ROS bag");
  const auto bags = files_with(path, ".bag");
  return !bags.empty() && is_kind(bags.front(), "ROS bag");
}

std::unique_ptr<ScanLog> open_ros1_bag_log(const fs::path& path, const ReadOptions& options) {
  require_valid(options);
  if (!fs::is_directory(path)) return log_of(open_ros1_bag(path), "rosbag", path, options);
  const auto bags = files_with(path, ".bag");
  if (bags.empty()) throw input_error(path, "has no .bag files");
  std::vector<std::unique_ptr<MessageSource>> parts;
  parts.reserve(bags.size());
  for (const fs::path& bag : bags) parts.push_back(open_ros1_bag(bag));
  return log_of(std::make_unique<JoinedSource>(std::move(parts)), "rosbag", path, options);
}

bool probe_ros2_bag(const fs::path& path) {
  std::error_code error;
  if (!fs::is_directory(path, error)) {
    return is_kind(path, "SQLite database") ||
           (is_ros2_bag_file(path) && is_kind(path, "zstd archive"));
  }
  const fs::directory_iterator files(path, error);
  return !error && std::any_of(begin(files), end(files), [](const fs::directory_entry& entry) {
    return is_ros2_bag_file(entry.path());
  });
}

std::unique_ptr<ScanLog> open_ros2_bag_log(const fs::path& path, const ReadOptions& options) {
  require_valid(options);
  return log_of(open_ros2_bag(path), "rosbag2", path, options);
}

bool probe_mcap(const fs::path& path) {
  return is_kind(path, "MCAP file");
}

std::unique_ptr<ScanLog> open_mcap_log(const fs::path& path, const ReadOptions& options) {
  require_valid(options);
  return log_of(open_mcap(path), "mcap", path, options);
}

}  // namespace kissmap
