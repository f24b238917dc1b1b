// SPDX-License-Identifier: MIT
#pragma once

#include <cmath>
#include <numbers>
#include <random>

#include "kissmap/formats/scan_log.hpp"

namespace kissmap {

/// A spinning sensor in a room: times, intensities, no-returns, dropped counts, all different.
inline Scan example_scan(std::uint32_t seed, std::size_t points = 1000) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> unit(-1.0F, 1.0F);
  Scan scan;
  scan.stamp_ns = 1'600'000'000'123'456'789 + seed;
  scan.stamp_instant = StampInstant::sweep_middle;
  scan.compensation = Compensation::no;
  scan.time_source = TimeSource::recorded;
  for (std::size_t i = 0; i < points; ++i) {
    const float share = static_cast<float>(i) / static_cast<float>(points);
    const float angle = 2.0F * std::numbers::pi_v<float> * share;
    const float range = 20.0F + 5.0F * unit(random);
    scan.points.emplace_back(range * std::cos(angle), range * std::sin(angle), unit(random));
    scan.time_offsets.push_back(0.1F * (share - 0.5F));
    scan.intensities.push_back(std::floor(100.0F * std::abs(unit(random))));
  }
  for (std::size_t i = 0; i < points / 10; ++i) {
    const Eigen::Vector3f direction(unit(random), unit(random), unit(random));
    scan.no_return_directions.push_back(direction.normalized());
    scan.no_return_time_offsets.push_back(0.05F * unit(random));
  }
  scan.dropped = {seed, 7, 1ULL << 40};
  return scan;
}

inline LogEntry entry_of(std::size_t index, Scan scan) {
  return {index, "scan " + std::to_string(index), std::move(scan)};
}

}  // namespace kissmap
