// SPDX-License-Identifier: MIT
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "kissmap/cloud/scan.hpp"
#include "kissmap/loop_closing/surface_link.hpp"
#include "kissmap/mapping/local_map.hpp"

namespace kissmap {

/// A stretch of the way too short to be bent by drift. Scans are counted as the mapper used them.
struct StretchPlace {
  std::uint32_t first_scan = 0;
  std::uint32_t end_scan = 0;     ///< one after the last
  std::uint32_t middle_scan = 0;  ///< in whose lidar frame its surfels are
  double voxel_size = 0.0;        ///< m, of its surfels
  double mean_range = 0.0;        ///< m, of the first scan: how far one sees here
  Eigen::Vector3d center = Eigen::Vector3d::Zero();  ///< m, mean of its surfels, in their frame
};

struct Stretch {
  StretchPlace place;
  SurfelCloud surfels;
  /// Of scans to the stretch before theirs, or to their own: all that were found since the stretch
  /// before this one was handed out.
  std::vector<SurfaceLink> scan_links;
};

/// Divides the way into stretches, each 0.15 mean ranges long or as long as the sensor turns by
/// less than 23 degrees, and finds the surfaces seen from them: voxels of a twentieth of the mean
/// range, 0.15 to 0.5 m.
///
/// Odometry that fits points to points wavers from scan to scan, and bends what it deskews. So each
/// scan is first registered to the planes of the three stretches before, from where odometry's
/// motion puts it: as of the middle of its sweep, because how a sweep was deskewed hardly moves
/// that, while the pose at its end and the motion through it depend on each other. Where sweeps end
/// follows from the middles before and after.
/// Not thread safe; the same result on every run.
class StretchBuilder {
 public:
  StretchBuilder(double min_range, double max_range);
  ~StretchBuilder();
  StretchBuilder(StretchBuilder&&) noexcept;
  StretchBuilder& operator=(StretchBuilder&&) noexcept;

  /// Takes the next scan the mapper used; every few points of a large one will do, see
  /// thinned_for_stretches(). Returns the stretch before, if this scan begins another.
  std::optional<Stretch> add(const Scan& scan, const MappedScan& mapped);

  /// The last stretch, if any scan was added. Call once, last.
  std::optional<Stretch> finish();

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

/// A copy without what StretchBuilder does not look at: at most 12,288 points, evenly picked,
/// of lasers that take turns all alike.
Scan thinned_for_stretches(const Scan& scan);

}  // namespace kissmap
