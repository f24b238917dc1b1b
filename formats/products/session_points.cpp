// SPDX-License-Identifier: MIT
#include "formats/products/session_points.hpp"

#include <string>

#include "kissmap/error.hpp"
#include "kissmap/formats/session_replay.hpp"

namespace kissmap {
namespace {

constexpr std::int64_t second_ns = 1'000'000'000;

// Whole seconds apart: a double holds them beside fractions, but not 19 digits of nanoseconds.
double seconds_of(std::int64_t stamp_ns, float later) {
  const std::int64_t whole = stamp_ns / second_ns;
  const auto rest = static_cast<double>(stamp_ns % second_ns);
  return static_cast<double>(whole) + (1e-9 * rest + static_cast<double>(later));
}

void for_each_point_of(const PlacedScan& scan,
                       const CropRegion& crop,
                       const std::function<void(const MapPoint&)>& take) {
  const Eigen::Matrix3d rotation = scan.map_from_lidar.rotation.toRotationMatrix();
  const Eigen::Matrix3f rotation_f = rotation.cast<float>();
  MapPoint point;
  point.scan_idx = static_cast<std::uint32_t>(scan.scan_idx);
  for (std::size_t i = 0; i < scan.points.size(); ++i) {
    point.position = rotation * scan.points[i].cast<double>() + scan.map_from_lidar.translation;
    if (!crop.contains(point.position)) continue;
    point.to_sensor = rotation_f * (scan.origins[i] - scan.points[i]);
    point.time =
        seconds_of(scan.pose_stamp_ns, scan.time_offsets.empty() ? 0.0F : scan.time_offsets[i]);
    if (!scan.intensities.empty()) point.intensity = scan.intensities[i];
    take(point);
  }
}

Error no_intensities(const Session& session, const PlacedScan& scan) {
  return input_error(session.manifest.log.path,
                     "scan " + std::to_string(session.scans[scan.scan_idx].log_index) +
                         " has no intensities; leave them out with --fields");
}

}  // namespace

void for_each_point(const Session& session,
                    const CloudExportOptions& options,
                    const CloudFields& fields,
                    const ExportProgress& progress,
                    const std::function<void(const MapPoint&)>& take) {
  SessionReplay replay(session, options.min_range, options.max_range, options.moved_log);
  while (const std::optional<PlacedScan> scan = replay.next()) {
    if (fields.intensity && scan->intensities.empty() && !scan->points.empty()) {
      throw no_intensities(session, *scan);
    }
    for_each_point_of(*scan, options.crop, take);
    progress("reading scans", scan->scan_idx + 1, replay.size());
  }
}

bool has_intensities(const Session& session, const CloudExportOptions& options) {
  SessionReplay replay(session, options.min_range, options.max_range, options.moved_log);
  while (const std::optional<PlacedScan> scan = replay.next()) {
    if (!scan->points.empty()) return !scan->intensities.empty();
  }
  return false;
}

}  // namespace kissmap
