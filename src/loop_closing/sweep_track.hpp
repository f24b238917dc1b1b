// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <deque>
#include <optional>
#include <span>
#include <vector>

#include "kissmap/cloud/scan.hpp"
#include "kissmap/cloud/voxel_filter.hpp"
#include "kissmap/loop_closing/surface_link.hpp"
#include "kissmap/loop_closing/surfel_registration.hpp"
#include "kissmap/mapping/local_map.hpp"

namespace kissmap {

/// Places sweeps on the surfaces of the latest stretches of the way, see StretchBuilder. All poses
/// are in one frame, the anchor: where the sweep of the latest stretch's middle scan ended, or the
/// first sweep of all.
class SweepTrack {
 public:
  SweepTrack(double min_range, double max_range);

  /// Places the next scan, by surfaces if there are some, in voxels of `voxel_size` [m].
  void place(const Scan& scan, const MappedScan& mapped, double voxel_size);
  /// The same by odometry's motion alone, without points.
  void follow(const Scan& scan, const MappedScan& mapped);

  /// Those of the last scan, where it was placed.
  std::span<const Eigen::Vector3f> points_in_anchor() const { return points_; }

  /// Ends a stretch whose middle is that scan, of those since the last one ended. Takes its surfels
  /// to the new anchor's frame and will place sweeps on them.
  void end_stretch(std::uint32_t middle_scan, double voxel_size, SurfelCloud& surfels);

  /// Links found since the last call.
  std::vector<SurfaceLink> take_links();
  /// No scan follows: the link of the last one.
  void finish();

 private:
  struct Sweep {
    std::uint32_t scan = 0;
    Rigid3 anchor_from_middle;
    double end = 0.0;       ///< s
    double seconds = 0.0;   ///< that it took; 0 if it is not deskewed: then its middle is its end
    Rigid3 start_from_end;  ///< by odometry
    std::optional<Information> information;  ///< if it was registered
  };

  Sweep predict(const Scan& scan, const MappedScan& mapped);
  void add(Sweep sweep);
  void link(std::size_t index);
  /// At most that many points to the sweep's middle, into points_.
  void deskew(const Scan& scan, const Sweep& sweep, std::size_t most);
  bool register_sweep(const Scan& scan, double voxel_size, Sweep& sweep);
  /// Near enough in time to tell a motion by both.
  static bool adjoin(const Sweep& before, const Sweep& after);
  Rigid3 start_from_end(const Sweep& sweep) const;  ///< of one that comes after the last
  Rigid3 anchor_from_end(std::size_t index) const;

  double min_range_;
  double max_range_;
  std::uint32_t scans_ = 0;
  std::uint32_t anchor_scan_ = 0;
  std::optional<MappedScan> before_;
  Rigid3 map_from_last_middle_;  ///< by odometry
  std::deque<Sweep> sweeps_;     ///< of the open stretch, and the two before
  std::deque<SurfelCloud> window_;
  std::optional<SurfelMap> surfaces_;
  std::vector<SurfaceLink> links_;
  VoxelFilter filter_;
  std::vector<Eigen::Vector3f> points_;
  std::vector<Eigen::Vector3f> samples_;
};

}  // namespace kissmap
