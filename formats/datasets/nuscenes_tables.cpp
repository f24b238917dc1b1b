// SPDX-License-Identifier: MIT
#include "formats/datasets/nuscenes_tables.hpp"

#include <algorithm>
#include <fstream>
#include <functional>
#include <map>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <utility>

#include "formats/trajectories/pose_fields.hpp"
#include "kissmap/error.hpp"

namespace kissmap {
namespace {

using nlohmann::json;
namespace fs = std::filesystem;

bool holds_tables(const fs::path& folder) {
  std::error_code error;
  return fs::is_regular_file(folder / "sample_data.json", error) &&
         fs::is_regular_file(folder / "scene.json", error);
}

std::vector<fs::path> folders_of_tables(const fs::path& path) {
  if (holds_tables(path)) return {path};
  std::vector<fs::path> found;
  std::error_code error;
  for (fs::directory_iterator entry(path, error), end; !error && entry != end;
       entry.increment(error)) {
    const bool named = entry->path().filename().string().starts_with("v1.0-");
    if (named && holds_tables(entry->path())) found.push_back(entry->path());
  }
  std::ranges::sort(found);
  return found;
}

json::other_error wrong_row(const char* problem, const json& row) {
  return json::other_error::create(501, problem, &row);
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

struct SceneRow {
  std::string name;
  std::string first_sample;
};

std::vector<SceneRow> read_scenes(const fs::path& tables) {
  std::vector<SceneRow> scenes;
  for_each_row(tables / "scene.json", [&](const json& row) {
    scenes.push_back({row.at("name"), row.at("first_sample_token")});
  });
  std::ranges::sort(scenes, {}, &SceneRow::name);
  return scenes;
}

SceneRow the_scene(const std::vector<SceneRow>& scenes,
                   const std::string& wanted,
                   const fs::path& tables) {
  std::string list;
  for (const SceneRow& scene : scenes) {
    if (scene.name == wanted) return scene;
    list += "\n  " + scene.name;
  }
  if (!wanted.empty()) {
    throw usage_error("--topic " + wanted + ": no such scene in " + tables.string() +
                      "; scenes:" + list);
  }
  if (scenes.size() == 1) return scenes.front();
  throw input_error(tables, "holds several scenes; choose one with --topic:" + list);
}

/// The library converts any number to any other.
std::int64_t microseconds_in(const json& row) {
  constexpr std::int64_t latest = 4'000'000'000'000'000;
  const json& stamp = row.at("timestamp");
  if (stamp.is_number_integer()) {
    const auto us = stamp.get<std::int64_t>();
    if (us >= 0 && us < latest) return us;
  }
  throw wrong_row("a timestamp is no whole number of microseconds", row);
}

std::vector<double> numbers_in(const json& row, const char* key, std::size_t count) {
  std::vector<double> numbers;
  for (const json& value : row.at(key)) {
    if (!value.is_number()) throw wrong_row("a pose has what is no number", row);
    numbers.push_back(value.get<double>());
  }
  if (numbers.size() != count) throw wrong_row("a pose has too many numbers, or too few", row);
  return numbers;
}

/// Quaternions begin with w.
Rigid3 pose_in(const json& row) {
  constexpr double farthest = 1e9;  // m
  const std::vector<double> t = numbers_in(row, "translation", 3);
  const std::vector<double> q = numbers_in(row, "rotation", 4);
  const Eigen::Vector3d position(t[0], t[1], t[2]);
  if (!(position.cwiseAbs().maxCoeff() <= farthest)) {
    throw wrong_row("a position beyond 1e9 m", row);
  }
  try {
    return {unit_quaternion({q[0], q[1], q[2], q[3]}), position};
  } catch (const std::invalid_argument& problem) {
    throw wrong_row(problem.what(), row);
  }
}

struct DataRow {
  std::string next;
  NuscenesScan scan;
};

std::vector<NuscenesScan> scans_of(const fs::path& tables, const std::string& first_sample) {
  std::map<std::string, DataRow> rows;
  std::string token;
  for_each_row(tables / "sample_data.json", [&](const json& row) {
    const std::string file = row.at("filename");
    if (file.find("LIDAR_TOP") == std::string::npos) return;
    rows[row.at("token")] = {row.at("next"),
                             {file,
                              1000 * microseconds_in(row),
                              row.value("ego_pose_token", ""),
                              row.value("calibrated_sensor_token", "")}};
    if (row.at("sample_token") == first_sample && row.at("is_key_frame")) token = row.at("token");
  });
  std::vector<NuscenesScan> scans;
  for (auto row = rows.find(token); row != rows.end() && scans.size() <= rows.size();
       row = rows.find(row->second.next)) {
    scans.push_back(row->second.scan);
  }
  return scans;
}

using Poses = std::map<std::string, std::optional<Rigid3>>;

/// The poses of those rows of a table that are wanted.
Poses poses_in(const fs::path& table,
               const std::vector<NuscenesScan>& scans,
               std::string NuscenesScan::*token) {
  Poses poses;
  for (const NuscenesScan& scan : scans) poses.try_emplace(scan.*token);
  for_each_row(table, [&](const json& row) {
    const auto pose = poses.find(row.at("token"));
    if (pose != poses.end()) pose->second = pose_in(row);
  });
  const auto missing =
      std::ranges::count_if(poses, [](const auto& pose) { return !pose.second.has_value(); });
  if (missing == 0) return poses;
  throw input_error(table,
                    "lacks " + std::to_string(missing) + " of the " + std::to_string(poses.size()) +
                        " poses of the scene's scans");
}

}  // namespace

fs::path nuscenes_tables_of(const fs::path& path) {
  const std::vector<fs::path> found = folders_of_tables(path);
  if (found.size() <= 1) return found.empty() ? fs::path() : found.front();
  std::string list;
  for (const fs::path& folder : found) list += "\n  " + folder.string();
  throw input_error(path, "holds several versions of the tables; give the folder of one:" + list);
}

bool has_nuscenes_tables(const fs::path& path) {
  return !folders_of_tables(path).empty();
}

NuscenesScene read_nuscenes_scene(const fs::path& tables, const std::string& wanted) {
  try {
    const SceneRow scene = the_scene(read_scenes(tables), wanted, tables);
    return {scene.name, scans_of(tables, scene.first_sample)};
  } catch (const json::exception& error) {
    throw input_error(tables, std::string("a row lacks what it should have: ") + error.what());
  }
}

std::vector<Rigid3> read_nuscenes_poses(const fs::path& tables, const NuscenesScene& scene) {
  const auto map_from_ego =
      poses_in(tables / "ego_pose.json", scene.scans, &NuscenesScan::ego_pose);
  const auto ego_from_lidar =
      poses_in(tables / "calibrated_sensor.json", scene.scans, &NuscenesScan::calibrated_sensor);
  std::vector<Rigid3> poses;
  for (const NuscenesScan& scan : scene.scans) {
    poses.push_back(*map_from_ego.at(scan.ego_pose) * *ego_from_lidar.at(scan.calibrated_sensor));
  }
  return poses;
}

std::optional<Rigid3> read_nuscenes_mount(const fs::path& tables, const NuscenesScene& scene) {
  std::error_code error;
  const fs::path table = tables / "calibrated_sensor.json";
  if (scene.scans.empty() || !fs::is_regular_file(table, error)) return std::nullopt;
  std::optional<Rigid3> ego_from_lidar;
  for_each_row(table, [&](const json& row) {
    if (row.at("token") == scene.scans.front().calibrated_sensor) ego_from_lidar = pose_in(row);
  });
  return ego_from_lidar;
}

}  // namespace kissmap
