// SPDX-License-Identifier: MIT
// nuScenes (Caesar et al., CVPR 2020): v1.0-*/scene.json, sample.json, sample_data.json and
// samples/, sweeps/LIDAR_TOP/*.pcd.bin with rows of x y z intensity ring (float32), HDL-32E at
// 20 Hz. Layout: nutonomy/nuscenes-devkit, schema_nuscenes.md and data_classes.py. Stamps are those
// of the last packet, clouds are compensated for motion (its developers, in their forum).
#include "formats/clouds/bin.hpp"
#include "formats/clouds/refusal.hpp"
#include "formats/clouds/scan_decoder.hpp"
#include "formats/datasets/dataset_folder.hpp"
#include "formats/datasets/datasets.hpp"
#include "formats/datasets/nuscenes_tables.hpp"
#include "formats/logs/folder_log.hpp"
#include "kissmap/error.hpp"

namespace kissmap {
namespace {

namespace fs = std::filesystem;

constexpr int columns = 5;

/// Where samples/ and sweeps/ lie: beside the tables.
fs::path root_of(const fs::path& path, const fs::path& tables) {
  return tables == path ? folder_of(path).parent_path() : path;
}

std::vector<ScanFile> scan_files(const fs::path& root, const NuscenesScene& scene) {
  std::vector<ScanFile> files;
  for (const NuscenesScan& scan : scene.scans) {
    const fs::path file = root / scan.file;
    std::error_code missing;
    const auto size = fs::file_size(file, missing);
    files.push_back({file, scan.file, missing ? 0 : size, scan.stamp_ns});
  }
  return files;
}

void add_notes(LogInfo& info, const fs::path& tables, const NuscenesScene& scene) {
  info.notes.push_back(scene.name + ", compensated for motion already");
  try {
    if (const auto mount = read_nuscenes_mount(tables, scene)) {
      info.notes.push_back(mount_note("the ego frame, by calibrated_sensor.json", *mount));
    }
  } catch (const Error& error) {
    // The scans can be read without it.
    info.notes.push_back(error.what());
  }
}

}  // namespace

bool probe_nuscenes(const fs::path& path) {
  return has_nuscenes_tables(path);
}

std::unique_ptr<ScanLog> open_nuscenes(const fs::path& path, const ReadOptions& options) {
  require_valid(options);
  const fs::path tables = nuscenes_tables_of(path);
  if (tables.empty())
    throw input_error(path, "has no v1.0-mini, v1.0-trainval or v1.0-test tables");
  const NuscenesScene scene = read_nuscenes_scene(tables, options.topic);
  if (scene.scans.empty()) throw input_error(tables, "the scene has no LIDAR_TOP files");
  FolderContent content;
  content.info.format = "nuscenes";
  content.info.path = path;
  content.info.sensor = "Velodyne HDL-32E";
  content.info.stamp_source = "sample_data.json";
  add_notes(content.info, tables, scene);
  content.scans = scan_files(root_of(path, tables), scene);
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
