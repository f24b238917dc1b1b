// SPDX-License-Identifier: MIT
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <vector>

namespace kissmap {

/// Which instant of a sweep a scan's stamp denotes.
enum class StampInstant : std::uint8_t { unknown, sweep_start, sweep_middle, sweep_end };

/// Where per-point times come from: nowhere, from the log, or computed from columns or azimuth.
enum class TimeSource : std::uint8_t { none, recorded, derived };

/// Whether the points were already moved to one instant. Deskewing twice does harm, so only `no`
/// and `unknown` are deskewed, and only where there are times.
enum class Compensation : std::uint8_t { unknown, no, yes };

/// Returns a reader left out of a scan, by cause.
struct DroppedReturns {
  std::uint64_t non_finite = 0;   ///< a coordinate or its time is NaN or infinite
  std::uint64_t zero = 0;         ///< exactly (0, 0, 0): how many formats write "no return"
  std::uint64_t implausible = 0;  ///< farther than max_plausible_range

  std::uint64_t total() const { return non_finite + zero + implausible; }
  DroppedReturns& operator+=(const DroppedReturns& other);
  friend bool operator==(const DroppedReturns&, const DroppedReturns&) = default;
};

/// No LiDAR on a ground robot sees this far; coordinates beyond are damage, not returns. [m]
inline constexpr float max_plausible_range = 10'000.0F;

/// One sweep of a LiDAR, as recorded. Every array but `no_return_directions` runs parallel to
/// `points`; an optional array is empty or has the same length.
/// Invariants (see `require_consistent`): points finite, not (0,0,0), within max_plausible_range;
/// time offsets finite; time_source is none exactly when time_offsets is empty.
struct Scan {
  std::int64_t stamp_ns = 0;    ///< ns since the log's epoch
  bool stamp_is_index = false;  ///< the log has no scan times; stamp_ns only counts scans
  StampInstant stamp_instant = StampInstant::unknown;
  Compensation compensation = Compensation::unknown;
  TimeSource time_source = TimeSource::none;

  std::vector<Eigen::Vector3f> points;  ///< m, lidar frame at the time of each point
  std::vector<float> time_offsets;      ///< s, relative to stamp_ns; may be negative
  std::vector<float> intensities;       ///< the sensor's own unit

  std::vector<Eigen::Vector3f> no_return_directions;  ///< unit vectors, lidar frame
  std::vector<float> no_return_time_offsets;          ///< s, parallel to the directions, or empty

  DroppedReturns dropped;
};

/// First and last time offset of the points [s]; none without times.
struct TimeSpan {
  float first = 0.0F;
  float last = 0.0F;
};
std::optional<TimeSpan> time_span(const Scan& scan);

/// Throws Error(internal) naming the invariant that does not hold. For tests and new readers.
void require_consistent(const Scan& scan);

}  // namespace kissmap
