// SPDX-License-Identifier: MIT
#include "kissmap/mapping/placed_scan.hpp"

#include "kissmap/odometry/preprocess.hpp"

namespace kissmap {
namespace {

constexpr double most_sweeps_back = 3.0;

std::optional<SweepMotion> final_motion(const Scan& scan,
                                        const MappedScan* before,
                                        const MappedScan& mapped) {
  const std::optional<TimeSpan> span = time_span(scan);
  if (!mapped.deskewed || !span) return std::nullopt;
  const double seconds = static_cast<double>(span->last) - span->first;
  return sweep_motion(scan, sweep_start_from_sweep_end(before, mapped, seconds));
}

}  // namespace

Rigid3 sweep_start_from_sweep_end(const MappedScan* before,
                                  const MappedScan& scan,
                                  double sweep_seconds) {
  if (before == nullptr) return scan.sweep_start_from_sweep_end;
  const double apart = 1e-9 * static_cast<double>(scan.pose_stamp_ns - before->pose_stamp_ns);
  if (!(apart > 0.0) || apart > most_sweeps_back * sweep_seconds) {
    return scan.sweep_start_from_sweep_end;
  }
  const Rigid3 before_from_scan = before->map_from_lidar.inverse() * scan.map_from_lidar;
  return exp(sweep_seconds / apart * log(before_from_scan));
}

PlacedScan place_scan(const Scan& scan,
                      const MappedScan* before,
                      const MappedScan& mapped,
                      double min_range,
                      double max_range) {
  PlacedScan placed;
  placed.pose_stamp_ns = mapped.pose_stamp_ns;
  placed.map_from_lidar = mapped.map_from_lidar;
  const std::optional<SweepMotion> motion = final_motion(scan, before, mapped);
  const auto min_squared = static_cast<float>(min_range * min_range);
  const auto max_squared = static_cast<float>(max_range * max_range);
  const auto late =
      static_cast<float>(1e-9 * static_cast<double>(mapped.pose_stamp_ns - scan.stamp_ns));
  const std::size_t n = scan.points.size();
  placed.points.reserve(n);
  placed.origins.reserve(n);
  if (!scan.intensities.empty()) placed.intensities.reserve(n);
  if (!scan.time_offsets.empty()) placed.time_offsets.reserve(n);
  for (std::size_t i = 0; i < n; ++i) {
    Eigen::Vector3f point = scan.points[i];
    Eigen::Vector3f origin = Eigen::Vector3f::Zero();
    if (motion) {
      point = motion->to_sweep_end(point, scan.time_offsets[i]);
      origin = motion->to_sweep_end(origin, scan.time_offsets[i]);
    }
    const float squared = point.squaredNorm();
    if (!(squared > min_squared && squared < max_squared)) continue;
    placed.points.push_back(point);
    placed.origins.push_back(origin);
    if (!scan.intensities.empty()) placed.intensities.push_back(scan.intensities[i]);
    if (!scan.time_offsets.empty()) placed.time_offsets.push_back(scan.time_offsets[i] - late);
  }
  return placed;
}

void place_no_returns(const Scan& scan,
                      const MappedScan* before,
                      const MappedScan& mapped,
                      PlacedScan& placed) {
  const std::optional<SweepMotion> motion = final_motion(scan, before, mapped);
  const bool timed = motion && !scan.no_return_time_offsets.empty();
  placed.no_return_directions = scan.no_return_directions;
  placed.no_return_origins.assign(scan.no_return_directions.size(), Eigen::Vector3f::Zero());
  if (!timed) return;
  for (std::size_t i = 0; i < scan.no_return_directions.size(); ++i) {
    const float time = scan.no_return_time_offsets[i];
    const Eigen::Vector3f origin = motion->to_sweep_end(Eigen::Vector3f::Zero(), time);
    placed.no_return_origins[i] = origin;
    placed.no_return_directions[i] =
        (motion->to_sweep_end(scan.no_return_directions[i], time) - origin).normalized();
  }
}

}  // namespace kissmap
