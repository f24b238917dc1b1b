// SPDX-License-Identifier: MIT
#include "simulator/simulator.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "simulator/random.hpp"

namespace kissmap::simulator {
namespace {

constexpr std::uint64_t noise_stream = 0x5343414E;

std::size_t scans_that_fit(const Motion& motion, const SensorModel& sensor) {
  return static_cast<std::size_t>(std::max(0.0, std::floor(motion.duration() / sensor.period)));
}

}  // namespace

struct Simulator::Shot {
  std::size_t scan_idx;
  std::size_t beam_idx;
  Eigen::Vector3d direction;  // lidar frame
  float time_offset;          // s
  double time;                // s
  Rigid3 map_from_lidar;
};

Simulator::Simulator(
    World world, SensorModel sensor, Motion motion, std::uint64_t seed, std::size_t scans)
    : caster_(std::move(world)),
      sensor_(std::move(sensor)),
      motion_(std::move(motion)),
      seed_(seed),
      scan_count_(scans > 0 ? scans : scans_that_fit(motion_, sensor_)) {
}

std::int64_t Simulator::stamp_ns(std::size_t scan_idx) const {
  const auto period_ns = static_cast<std::int64_t>(std::llround(sensor_.period * 1e9));
  return first_stamp_ns + static_cast<std::int64_t>(scan_idx) * period_ns;
}

Rigid3 Simulator::map_from_lidar(std::int64_t stamp_ns) const {
  return motion_.world_from_lidar(1e-9 * static_cast<double>(stamp_ns - first_stamp_ns));
}

Scan Simulator::scan(std::size_t scan_idx) const {
  return labelled_scan(scan_idx).scan;
}

LabelledScan Simulator::labelled_scan(std::size_t scan_idx) const {
  LabelledScan result;
  result.scan.stamp_ns = stamp_ns(scan_idx);
  result.scan.stamp_instant = StampInstant::sweep_start;
  result.scan.compensation = Compensation::no;
  result.scan.time_source = TimeSource::recorded;
  const double start = 1e-9 * static_cast<double>(result.scan.stamp_ns - first_stamp_ns);
  std::optional<Shot> shot;
  for (std::size_t i = 0; i < sensor_.pattern.size(); ++i) {
    const Beam fired = beam(sensor_, scan_idx, i);
    // The world is seen at the time that the scan will tell, so that noise-free points are exact.
    const auto offset = static_cast<float>(fired.time_offset);
    const double time = start + static_cast<double>(offset);
    const bool same_column = shot && shot->time == time;
    const Rigid3 pose = same_column ? shot->map_from_lidar : motion_.world_from_lidar(time);
    shot = Shot{scan_idx, i, fired.direction, offset, time, pose};
    shoot(*shot, result);
  }
  return result;
}

void Simulator::shoot(const Shot& shot, LabelledScan& result) const {
  Scan& scan = result.scan;
  const Eigen::Vector3d direction_in_map = shot.map_from_lidar.rotation * shot.direction;
  const std::optional<Hit> hit =
      caster_.cast(shot.map_from_lidar.translation, direction_in_map, shot.time, sensor_.max_range);
  if (!hit) {
    scan.no_return_directions.emplace_back(shot.direction.cast<float>());
    scan.no_return_time_offsets.push_back(shot.time_offset);
    return;
  }
  Random random{seed_, noise_stream, shot.scan_idx, shot.beam_idx};
  if (random.chance(sensor_.dropout)) return;
  const double range = hit->range + sensor_.range_noise * random.normal();
  if (range < sensor_.min_range) return;
  const double facing = std::abs(hit->normal.dot(direction_in_map));
  scan.points.emplace_back((range * shot.direction).cast<float>());
  scan.time_offsets.push_back(shot.time_offset);
  scan.intensities.push_back(static_cast<float>(255.0 * hit->primitive->reflectivity * facing));
  result.classes.push_back(hit->primitive->object_class);
  result.true_ranges.push_back(hit->range);
}

}  // namespace kissmap::simulator
