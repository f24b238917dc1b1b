// SPDX-License-Identifier: MIT
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <functional>
#include <vector>

#include "formats/sensors/packet_bytes.hpp"
#include "kissmap/cloud/scan.hpp"

namespace kissmap {

/// Cuts the points of a turning sensor into sweeps of one turn each.
///
/// A sweep ends where the azimuth has come round to that of the first column after the beginning
/// or the last interruption. Sensors set to a part of the turn jump over the rest: any step but one
/// of less than 10 degrees backwards counts as forwards. A sweep also ends at an interruption of
/// more than 0.3 s or of more than half a turn, after a second (a motor at rest) and at four
/// million shots, which count as they are offered, whatever becomes of them: sweeps end at the same
/// places whether they are decoded or passed over.
///
/// Stamps are the sensor's time of the earliest point. Where the sensor's clock is more than a day
/// from the receiver's it was never set (1970, 2000): the stamp is then the time at which the
/// sweep's first packet was received, and times of points remain the sensor's.
class SweepBuilder {
 public:
  /// Complete sweeps are appended to `sweeps`, which has to outlive the builder.
  explicit SweepBuilder(std::deque<Scan>& sweeps) : sweeps_(sweeps) {}

  /// The points that follow belong to a column of shots that begins at this azimuth and time of the
  /// sensor's clock, in a packet received at `host_ns`. `shots` are all it may add, each return
  /// one.
  void begin_column(double azimuth_deg,
                    std::int64_t time_ns,
                    std::int64_t host_ns,
                    std::size_t shots);

  /// Calls `decode` with the bytes of the packet, to add what the column at hand has. Where the
  /// sweep is passed over and known to have a point, that is put off, and forgotten at its end.
  template <class Decode>
  void decode_column(KeptPacket& packet, Decode decode) {
    if (wants_shots()) return decode(packet.bytes());
    put_off_.push_back([decode, copy = packet.copy()] { decode(PacketBytes(*copy)); });
  }

  /// The next `sweeps` sweeps, beginning with the one at hand, are passed over. Replaces what was
  /// said before: what was put off is decoded if the sweep at hand is wanted after all.
  void pass(std::size_t sweeps);

  /// A return at `time_ns` by the sensor's clock. One that cannot be is dropped and counted.
  void add(const Eigen::Vector3f& point, float intensity, std::int64_t time_ns);

  /// A shot in this direction (unit, of the sensor's frame) that nothing came back of. Forgotten if
  /// nothing came back of the whole column: that is what a sensor writes, too, where its shots are
  /// switched off or covered.
  void add_no_return(const Eigen::Vector3f& direction, std::int64_t time_ns);

  /// What was begun becomes a sweep, unless it has no points.
  void finish();

 private:
  /// A sweep without a point is none: only after the first is the rest known to count for nothing.
  bool wants_shots() const { return to_pass_ == 0 || scan_.points.empty(); }
  void place_column(double azimuth_deg, std::int64_t time_ns, std::int64_t host_ns);
  bool turn_was_lost(double step_deg, double passed_s);
  void restart(double azimuth_deg, std::int64_t time_ns, std::int64_t host_ns);
  void begin_sweep(std::int64_t time_ns, std::int64_t host_ns);
  void end_column();

  std::deque<Scan>& sweeps_;
  Scan scan_;
  std::vector<std::int64_t> times_ns_;
  std::vector<std::int64_t> no_return_times_ns_;
  std::size_t shots_ = 0;  ///< that the columns of the sweep offered
  std::size_t to_pass_ = 0;
  std::vector<std::function<void()>> put_off_;  ///< by column
  std::size_t column_points_ = 0;               ///< before the column at hand
  std::size_t column_no_returns_ = 0;           ///< as well
  bool begun_ = false;
  std::int64_t sweep_time_ns_ = 0;
  std::int64_t sweep_host_ns_ = 0;
  std::int64_t last_time_ns_ = 0;
  double last_azimuth_deg_ = 0.0;
  double covered_deg_ = 0.0;
  double deg_per_s_ = 0.0;
};

}  // namespace kissmap
