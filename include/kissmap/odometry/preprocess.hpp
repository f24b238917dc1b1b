// SPDX-License-Identifier: MIT
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "kissmap/cloud/scan.hpp"
#include "kissmap/geometry/rigid3.hpp"
#include "kissmap/parallel/thread_pool.hpp"

namespace kissmap {

/// A constant-velocity motion through one sweep, and what moves a point recorded at time t to the
/// sweep's end: exp((s - 1) log(start_from_end)), s = (t - first) / (last - first).
/// Evaluated from 257 knots with linear interpolation between them; at an angle of a rad per sweep
/// the error is below a^2 / 5e5 of the point's range (0.02 mm at 100 m and 0.3 rad).
class SweepMotion {
 public:
  /// `span.last` > `span.first`.
  SweepMotion(const Rigid3& start_from_end, TimeSpan span);

  /// A point in the lidar frame of its own time -> the lidar frame at the sweep's end.
  /// Times outside the span count as its ends.
  Eigen::Vector3f to_sweep_end(const Eigen::Vector3f& point, float time_offset) const;

 private:
  static constexpr int intervals = 256;
  Eigen::Matrix<float, 3, 4> knots_[intervals + 1];
  float first_;
  float knots_per_second_;
};

/// The sweep motion of a scan, or none where it must not or cannot be deskewed: already
/// compensated, no times, or all times equal.
std::optional<SweepMotion> sweep_motion(const Scan& scan, const Rigid3& start_from_end);

/// Deskews (if there is a motion) and keeps the points with min_range < range < max_range [m], in
/// order. Range is measured after deskewing. `kept` is overwritten; its memory is reused.
void deskew_and_crop(const Scan& scan,
                     const std::optional<SweepMotion>& motion,
                     double min_range,
                     double max_range,
                     ThreadPool& pool,
                     std::vector<Eigen::Vector3f>& kept);

}  // namespace kissmap
