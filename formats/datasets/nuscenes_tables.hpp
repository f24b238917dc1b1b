// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "kissmap/geometry/rigid3.hpp"

namespace kissmap {

/// The tables of nuScenes, v1.0-*/*.json, read row by row, since those of the whole data set are
/// larger than memory. Layout: nutonomy/nuscenes-devkit, schema_nuscenes.md. All functions throw
/// Error(input) naming the table.
///
/// A path stands for a folder of tables: itself, or the only one in it whose name begins with
/// "v1.0-". Empty if it is neither; an error with the list if there are several.
std::filesystem::path nuscenes_tables_of(const std::filesystem::path& path);

/// True if there is at least one.
bool has_nuscenes_tables(const std::filesystem::path& path);

/// A file of LIDAR_TOP.
struct NuscenesScan {
  std::string file;  ///< relative to the parent of the tables
  std::int64_t stamp_ns = 0;
  std::string ego_pose;           ///< token; empty where the row has none
  std::string calibrated_sensor;  ///< token; empty where the row has none
};

struct NuscenesScene {
  std::string name;
  std::vector<NuscenesScan> scans;  ///< in recorded order, sweeps between the samples included
};

/// The scene called `wanted`, or the only one if that is empty. Throws Error(usage) if there is
/// none of that name. Some 150 MB for the tables of the whole data set.
NuscenesScene read_nuscenes_scene(const std::filesystem::path& tables, const std::string& wanted);

/// map_from_lidar of each scan: its ego_pose times its calibrated_sensor.
std::vector<Rigid3> read_nuscenes_poses(const std::filesystem::path& tables,
                                        const NuscenesScene& scene);

/// ego_from_lidar, by calibrated_sensor.json; nothing where the table or the row is missing.
std::optional<Rigid3> read_nuscenes_mount(const std::filesystem::path& tables,
                                          const NuscenesScene& scene);

}  // namespace kissmap
