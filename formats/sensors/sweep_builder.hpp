// SPDX-License-Identifier: MIT
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <vector>

#include "kissmap/cloud/scan.hpp"

namespace kissmap {

/// Cuts the points of a turning sensor into sweeps of one turn each.
///
/// A sweep ends where the azimuth has come round to that of the first column after the beginning
/// or the last interruption. Sensors set to a part of the turn jump over the rest: any step but one
/// of less than 10 degrees backwards counts as forwards. A sweep also ends at an interruption of
/// more than 0.3 s or of more than half a turn, after a second (a motor at rest) and at four
/// million shots.
///
/// Stamps are the sensor's time of the earliest point. Where the sensor's clock is more than a day
/// from the receiver's it was never set (1970, 2000): the stamp is then the time at which the
/// sweep's first packet was received, and times of points remain the sensor's.
class SweepBuilder {
 public:
  /// Complete sweeps are appended to `sweeps`, which has to outlive the builder.
  explicit SweepBuilder(std::deque<Scan>& sweeps) : sweeps_(sweeps) {}

  /// The points that follow belong to a column of shots that begins at this azimuth and time of the
  /// sensor's clock, in a packet received at `host_ns`.
  void begin_column(double azimuth_deg, std::int64_t time_ns, std::int64_t host_ns);

  /// A return at `time_ns` by the sensor's clock. One that cannot be is dropped and counted.
  void add(const Eigen::Vector3f& point, float intensity, std::int64_t time_ns);

  /// A shot in this direction (unit, of the sensor's frame) that nothing came back of. Forgotten if
  /// nothing came back of the whole column: that is what a sensor writes, too, where its shots are
  /// switched off or covered.
  void add_no_return(const Eigen::Vector3f& direction, std::int64_t time_ns);

  /// What was begun becomes a sweep, unless it has no points.
  void finish();

 private:
  bool turn_was_lost(double step_deg, double passed_s);
  void restart(double azimuth_deg, std::int64_t time_ns, std::int64_t host_ns);
  void begin_sweep(std::int64_t time_ns, std::int64_t host_ns);
  void end_column();

  std::deque<Scan>& sweeps_;
  Scan scan_;
  std::vector<std::int64_t> times_ns_;
  std::vector<std::int64_t> no_return_times_ns_;
  std::size_t column_points_ = 0;      ///< before the column at hand
  std::size_t column_no_returns_ = 0;  ///< as well
  bool begun_ = false;
  std::int64_t sweep_time_ns_ = 0;
  std::int64_t sweep_host_ns_ = 0;
  std::int64_t last_time_ns_ = 0;
  double last_azimuth_deg_ = 0.0;
  double covered_deg_ = 0.0;
  double deg_per_s_ = 0.0;
};

}  // namespace kissmap
