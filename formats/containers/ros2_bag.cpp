// SPDX-License-Identifier: MIT
#include "formats/containers/ros2_bag.hpp"

#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <map>
#include <utility>

#include "formats/containers/bag_metadata.hpp"
#include "formats/containers/joined_source.hpp"
#include "formats/containers/mcap.hpp"
#include "formats/containers/sqlite_bag.hpp"
#include "formats/containers/unpacked_file.hpp"
#include "formats/text/lower_case.hpp"
#include "formats/text/stamps.hpp"
#include "kissmap/error.hpp"

namespace kissmap {
namespace {

namespace fs = std::filesystem;

constexpr const char* packed_extension = ".zstd";
constexpr std::uint64_t most_bytes_to_count = 32 << 20;  // of all files of a bag

struct Metadata {
  std::vector<fs::path> files;
  std::map<std::string, std::uint64_t> counts;  // of messages, by topic
};

// Names without a folder of their own: a bag does not reach out of its folder.
fs::path file_named(const fs::path& folder, const std::string& name) {
  fs::path file = folder / fs::path(name).filename();
  if (fs::exists(file)) return file;
  fs::path packed = file;
  packed += packed_extension;
  if (fs::exists(packed)) return packed;
  throw input_error(folder / "metadata.yaml",
                    "names the file '" + name +
                        "', which is not there; copy it into the folder, "
                        "or remove metadata.yaml to read what there is");
}

Metadata read_metadata(const fs::path& folder) {
  const fs::path path = folder / "metadata.yaml";
  Metadata metadata;
  try {
    const YAML::Node root = YAML::LoadFile(path.string())["rosbag2_bagfile_information"];
    for (const YAML::Node& name : root["relative_file_paths"]) {
      metadata.files.push_back(file_named(folder, name.as<std::string>()));
    }
    metadata.counts = recorded_counts(root);
  } catch (const YAML::Exception& error) {
    throw input_error(
        path,
        std::string(error.what()) + "; repair it, or remove it: the bag is read without, too");
  }
  return metadata;
}

// Their number in the name tells the order where their times do not.
std::vector<fs::path> bag_files(const fs::path& folder) {
  std::vector<fs::path> files;
  for (const auto& entry : fs::directory_iterator(folder)) {
    if (is_ros2_bag_file(entry.path())) files.push_back(entry.path());
  }
  std::ranges::sort(files, natural_less, [](const fs::path& p) { return p.filename().string(); });
  return files;
}

std::unique_ptr<MessageSource> open_file(const fs::path& file, std::uint64_t most_bytes) {
  if (lower_case(file.extension().string()) == packed_extension) {
    return open_unpacked(file,
                         [=](const fs::path& unpacked) { return open_file(unpacked, most_bytes); });
  }
  if (lower_case(file.extension().string()) == ".mcap") return open_mcap(file);
  return open_sqlite_bag(file, most_bytes);
}

}  // namespace

bool is_ros2_bag_file(const fs::path& path) {
  fs::path name = path.filename();
  if (lower_case(name.extension().string()) == packed_extension) name = name.stem();
  const std::string extension = lower_case(name.extension().string());
  return extension == ".db3" || extension == ".mcap";
}

std::unique_ptr<MessageSource> open_ros2_bag(const fs::path& path) {
  if (!fs::is_directory(path)) return open_file(path, most_bytes_to_count);
  const bool described = fs::exists(path / "metadata.yaml");
  Metadata metadata = described ? read_metadata(path) : Metadata{};
  if (metadata.files.empty()) metadata.files = bag_files(path);
  if (metadata.files.empty()) throw input_error(path, "has neither .db3 nor .mcap files");
  std::vector<std::unique_ptr<MessageSource>> parts;
  parts.reserve(metadata.files.size());
  const std::uint64_t for_each = described ? 0 : most_bytes_to_count / metadata.files.size();
  for (const fs::path& file : metadata.files) parts.push_back(open_file(file, for_each));
  auto joined = std::make_unique<JoinedSource>(std::move(parts));
  joined->set_counts(metadata.counts);
  return joined;
}

}  // namespace kissmap
