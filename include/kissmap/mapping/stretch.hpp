// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <optional>

#include "kissmap/cloud/scan.hpp"
#include "kissmap/mapping/local_map.hpp"
#include "kissmap/odometry/voxel_hash_map.hpp"

namespace kissmap {

/// A stretch of the way too short to be bent by drift. Scans are counted as the mapper used them.
struct StretchPlace {
  std::uint32_t first_scan = 0;
  std::uint32_t end_scan = 0;     ///< one after the last
  std::uint32_t middle_scan = 0;  ///< in whose lidar frame its surfels are
  double voxel_size = 0.0;        ///< m, of its surfels
  double mean_range = 0.0;        ///< m, of the first scan: how far one sees here
};

struct Stretch {
  StretchPlace place;
  SurfelCloud surfels;
};

/// Divides the way into stretches, each 0.15 mean ranges long or as long as the sensor turns by
/// less than 23 degrees, and finds the surfaces seen from them: voxels of a twentieth of the mean
/// range, 0.15 to 0.5 m. Points are deskewed by the motion from scan to scan that odometry found.
/// Not thread safe; the same result on every run.
class StretchBuilder {
 public:
  StretchBuilder(double min_range, double max_range);

  /// Takes the next scan the mapper used; every few points of a large one will do, see
  /// thinned_for_stretches(). Returns the stretch before, if this scan begins another.
  std::optional<Stretch> add(const Scan& scan, const MappedScan& mapped);

  /// The last stretch, if any scan was added. Call once, last.
  std::optional<Stretch> finish();

 private:
  void begin(const Scan& scan);
  bool is_long_enough() const;
  Stretch close();

  double min_range_;
  double max_range_;
  std::optional<VoxelHashMap> grid_;  ///< of the open stretch, in the frame of its first scan
  StretchPlace place_;
  std::vector<Rigid3> first_from_scan_;  ///< of the open stretch
  double way_ = 0.0;                     ///< m
  double turn_ = 0.0;                    ///< rad
  std::uint32_t scans_ = 0;
  std::optional<MappedScan> before_;
};

/// A copy without what StretchBuilder does not look at: at most 16,384 points, evenly picked.
Scan thinned_for_stretches(const Scan& scan);

}  // namespace kissmap
