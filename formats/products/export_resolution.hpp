// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>

#include "kissmap/mapping/placed_scan.hpp"

namespace kissmap {

/// How far things are from the sensor, over all points of some scans.
class MeanRange {
 public:
  void add(const PlacedScan& scan);
  double value() const;  ///< m; 0 without a point

 private:
  double sum_ = 0.0;
  std::uint64_t points_ = 0;
};

/// Side of a cell or voxel [m], the finer the nearer things are: 0.05, 0.1 or 0.2.
double resolution_for(double mean_range);

}  // namespace kissmap
