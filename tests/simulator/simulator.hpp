// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "kissmap/cloud/scan.hpp"
#include "simulator/motion.hpp"
#include "simulator/ray_caster.hpp"
#include "simulator/sensor.hpp"

namespace kissmap::simulator {

/// A scan and what each of its points truly lies on, how far away (parallel to scan.points).
struct LabelledScan {
  Scan scan;
  std::vector<ObjectClass> classes;
  std::vector<double> true_ranges;  ///< m, without noise
};

/// A LiDAR moving through a world. Each beam is cast from the true pose at its own time, and moving
/// objects stand where they are at that time. Frames: `map` is the world's frame, z up.
/// Scan i depends only on the arguments and i. Immutable, so scans may be made by many threads.
class Simulator {
 public:
  /// 2023-11-14 22:13:20 UTC, so that stamps have as many digits as real ones. [ns]
  static constexpr std::int64_t first_stamp_ns = 1'700'000'000'000'000'000;

  /// `scans` = 0 takes as many as fit into the motion.
  Simulator(
      World world, SensorModel sensor, Motion motion, std::uint64_t seed, std::size_t scans = 0);

  std::size_t scan_count() const { return scan_count_; }
  const SensorModel& sensor() const { return sensor_; }
  const Motion& motion() const { return motion_; }
  const RayCaster& caster() const { return caster_; }

  /// Start of sweep i; it ends where the next begins.
  std::int64_t stamp_ns(std::size_t scan_idx) const;

  /// Points in the lidar frame at the time of each point, in the order of firing; stamp = start of
  /// the sweep; intensity 0..255 = reflectivity times cosine of incidence. Beams that hit nothing
  /// within range are the no-return directions; dropouts and too near returns leave no trace.
  Scan scan(std::size_t scan_idx) const;
  LabelledScan labelled_scan(std::size_t scan_idx) const;

  /// Truth, at any time.
  Rigid3 map_from_lidar(std::int64_t stamp_ns) const;

 private:
  struct Shot;
  void shoot(const Shot& shot, LabelledScan& result) const;

  RayCaster caster_;
  SensorModel sensor_;
  Motion motion_;
  std::uint64_t seed_;
  std::size_t scan_count_;
};

}  // namespace kissmap::simulator
