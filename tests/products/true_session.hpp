// SPDX-License-Identifier: MIT
#pragma once

#include <cmath>
#include <filesystem>
#include <vector>

#include "kissmap/formats/registry.hpp"
#include "kissmap/formats/session.hpp"
#include "simulator/simulator.hpp"

namespace kissmap {

/// Writes a session that has every scan of a log exactly where `place` says, without mapping. Its
/// only local map, which lies at the origin, has surfels at `means`.
template <class Place>
void write_true_session(const std::filesystem::path& log_path,
                        const std::filesystem::path& path,
                        Place&& place,
                        const std::vector<Eigen::Vector3f>& means = {{0.0F, 0.0F, -1.0F},
                                                                     {1.0F, 0.0F, 2.0F}}) {
  SessionManifest manifest;
  manifest.log.path = log_path;
  manifest.configuration = "[odometry]\nmax_range = 30.0\nmin_range = 0.5\n";
  SessionWriter writer(path, false);
  const auto log = open_log(log_path);
  while (const auto entry = log->next()) {
    const Scan& scan = std::get<Scan>(entry->content);
    SessionScan row;
    row.log_index = entry->index;
    row.mapped = place(scan);
    row.mapped.points_read = scan.points.size();
    writer.add_scan(row);
    ++manifest.counts.scans_used;
  }
  manifest.log.format = log->info().format;
  manifest.log.stamp_source = log->info().stamp_source;
  manifest.log.files = log->files();
  LocalMap map;
  map.scan_count = manifest.counts.scans_used;
  map.surfels.means = means;
  map.surfels.normals.assign(means.size(), {0.0F, 0.0F, 1.0F});
  writer.add_local_map(map);
  writer.finish(manifest);
}

/// Where a scan of a simulated log truly is, in a map that lies in the world as it is said.
inline MappedScan true_place(const simulator::Simulator& simulator,
                             const Scan& scan,
                             const Rigid3& map_from_world) {
  MappedScan mapped;
  mapped.stamp_ns = scan.stamp_ns;
  mapped.pose_stamp_ns =
      scan.stamp_ns + std::llround(1e9 * static_cast<double>(time_span(scan)->last));
  mapped.map_from_lidar = map_from_world * simulator.map_from_lidar(mapped.pose_stamp_ns);
  mapped.local_map_from_lidar = mapped.map_from_lidar;
  mapped.deskewed = true;
  // What odometry would have found for the first scan, which has none before it.
  mapped.sweep_start_from_sweep_end = simulator.map_from_lidar(scan.stamp_ns).inverse() *
                                      simulator.map_from_lidar(mapped.pose_stamp_ns);
  return mapped;
}

}  // namespace kissmap
