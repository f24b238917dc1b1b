// SPDX-License-Identifier: MIT
#include "formats/products/resolution.hpp"

#include <algorithm>

#include "kissmap/formats/session_replay.hpp"

namespace kissmap {
namespace {

constexpr std::uint64_t scans_looked_at = 50;

FittingResolution resolution_for(double mean_range) {
  if (mean_range < 8.0) return {0.05, 0.05};
  return {mean_range < 20.0 ? 0.1 : 0.2, 0.2};
}

}  // namespace

FittingResolution fitting_resolution(const Session& session,
                                     double min_range,
                                     double max_range,
                                     const std::filesystem::path& moved_log) {
  const std::uint64_t every = std::max<std::uint64_t>(1, session.scans.size() / scans_looked_at);
  SessionReplay replay(session, min_range, max_range, moved_log, every);
  double range_sum = 0.0;
  std::uint64_t points = 0;
  while (const std::optional<PlacedScan> scan = replay.next()) {
    for (const Eigen::Vector3f& point : scan->points)
      range_sum += static_cast<double>(point.norm());
    points += scan->points.size();
  }
  return resolution_for(points == 0 ? 0.0 : range_sum / static_cast<double>(points));
}

}  // namespace kissmap
