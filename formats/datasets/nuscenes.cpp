// SPDX-License-Identifier: MIT
// nuScenes (Caesar et al., CVPR 2020): v1.0-*/scene.json, sample.json, sample_data.json and
// samples/, sweeps/LIDAR_TOP/*.pcd.bin with rows of x y z intensity ring (float32), HDL-32E at
// 20 Hz. Layout: nutonomy/nuscenes-devkit, schema_nuscenes.md and data_classes.py. Stamps are those
// of the last packet, clouds are compensated for motion (its developers, in their forum).
#include <algorithm>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <utility>

#include "formats/clouds/bin.hpp"
#include "formats/clouds/refusal.hpp"
#include "formats/clouds/scan_decoder.hpp"
#include "formats/datasets/datasets.hpp"
#include "formats/logs/folder_log.hpp"
#include "kissmap/error.hpp"

namespace kissmap {
namespace {

using nlohmann::json;
namespace fs = std::filesystem;

constexpr int columns = 5;
constexpr const char* tables[] = {"v1.0-mini", "v1.0-trainval", "v1.0-test"};

fs::path tables_of(const fs::path& root) {
  std::error_code error;
  for (const char* name : tables) {
    if (fs::is_regular_file(root / name / "sample_data.json", error)) return root / name;
  }
  return {};
}

/// Calls `take` with each object of a table, a list that may be larger than memory.
void for_each_row(const fs::path& file, const std::function<void(const json&)>& take) {
  std::ifstream in(file);
  if (!in) throw input_error(file, "cannot be read");
  // Each row is handed on as soon as it is complete, and forgotten.
  const auto row_done = [&](int depth, json::parse_event_t event, json& value) {
    if (depth != 1 || event != json::parse_event_t::object_end) return true;
    take(value);
    return false;
  };
  try {
    [[maybe_unused]] const json rest = json::parse(in, row_done);
  } catch (const json::exception& error) {
    throw input_error(file, std::string("is broken: ") + error.what());
  }
}

struct Row {
  std::string next;
  std::string file;
  std::int64_t stamp_ns = 0;
};

struct Scene {
  std::string name;
  std::string first_sample;
};

std::vector<Scene> read_scenes(const fs::path& folder) {
  std::vector<Scene> scenes;
  for_each_row(folder / "scene.json", [&](const json& row) {
    scenes.push_back({row.at("name"), row.at("first_sample_token")});
  });
  std::ranges::sort(scenes, {}, &Scene::name);
  return scenes;
}

Scene the_scene(const std::vector<Scene>& scenes, const std::string& wanted, const fs::path& root) {
  std::string list;
  for (const Scene& scene : scenes) {
    if (scene.name == wanted) return scene;
    list += "\n  " + scene.name;
  }
  if (!wanted.empty()) {
    throw usage_error("--topic " + wanted + ": no such scene in " + root.string() +
                      "; scenes:" + list);
  }
  if (scenes.size() == 1) return scenes.front();
  throw input_error(root, "holds several scenes; choose one with --topic:" + list);
}

/// The library converts any number to any other.
std::int64_t microseconds_in(const json& row) {
  constexpr std::int64_t latest = 4'000'000'000'000'000;
  const json& stamp = row.at("timestamp");
  if (stamp.is_number_integer()) {
    const auto us = stamp.get<std::int64_t>();
    if (us >= 0 && us < latest) return us;
  }
  throw json::other_error::create(501, "a timestamp is no whole number of microseconds", &row);
}

/// The LiDAR's files of a scene, sweeps between the samples included.
std::vector<ScanFile> scans_of(const fs::path& root, const fs::path& folder, const Scene& scene) {
  std::map<std::string, Row> rows;
  std::string token;
  for_each_row(folder / "sample_data.json", [&](const json& row) {
    const std::string file = row.at("filename");
    if (file.find("LIDAR_TOP") == std::string::npos) return;
    rows[row.at("token")] = {row.at("next"), file, 1000 * microseconds_in(row)};
    if (row.at("sample_token") == scene.first_sample && row.at("is_key_frame"))
      token = row.at("token");
  });
  std::vector<ScanFile> scans;
  for (auto row = rows.find(token); row != rows.end() && scans.size() <= rows.size();
       row = rows.find(row->second.next)) {
    const fs::path file = root / row->second.file;
    std::error_code missing;
    const auto size = fs::file_size(file, missing);
    scans.push_back({file, row->second.file, missing ? 0 : size, row->second.stamp_ns});
  }
  return scans;
}

}  // namespace

bool probe_nuscenes(const fs::path& path) {
  return !tables_of(path).empty();
}

std::unique_ptr<ScanLog> open_nuscenes(const fs::path& path, const ReadOptions& options) {
  require_valid(options);
  const fs::path folder = tables_of(path);
  if (folder.empty())
    throw input_error(path, "has no v1.0-mini, v1.0-trainval or v1.0-test tables");
  FolderContent content;
  content.info.format = "nuscenes";
  content.info.path = path;
  content.info.sensor = "Velodyne HDL-32E";
  content.info.stamp_source = "sample_data.json";
  try {
    const Scene scene = the_scene(read_scenes(folder), options.topic, path);
    content.info.notes.push_back(scene.name + ", compensated for motion already");
    content.scans = scans_of(path, folder, scene);
  } catch (const json::exception& error) {
    throw input_error(folder, std::string("a row lacks what it should have: ") + error.what());
  }
  if (content.scans.empty()) throw input_error(folder, "the scene has no LIDAR_TOP files");
  std::vector<std::int64_t> stamps;
  for (const ScanFile& scan : content.scans) stamps.push_back(*scan.stamp_ns);
  auto decoder = std::make_shared<ScanDecoder>(options);
  content.decode = [=](std::span<const std::byte> bytes, std::size_t index) {
    if (bytes.empty()) throw Refusal(refusal_reason::empty, "the file has 0 bytes; copy it anew");
    Scan scan = decoder->decode(read_bin(bytes, columns), stamps[index]);
    scan.stamp_instant = StampInstant::sweep_end;
    scan.compensation = Compensation::yes;
    return scan;
  };
  return std::make_unique<FolderLog>(std::move(content));
}

}  // namespace kissmap
