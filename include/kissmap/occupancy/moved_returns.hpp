// SPDX-License-Identifier: MIT
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <memory>

#include "kissmap/mapping/placed_scan.hpp"
#include "kissmap/parallel/thread_pool.hpp"

namespace kissmap {

struct MovedReturnsOptions {
  double voxel_size = 0.1;  ///< m
  /// A voxel was passed if more than this number of passages comes on each hit, in it and its 26
  /// neighbours together, where its own count nine times.
  double passages_per_hit = 0.92;
  double seconds_together = 0.5;  ///< that scans with and without a return may be apart
};

/// Tells the returns of what moved from those of what stands, by the rays of other scans that
/// passed through where the returns are.
///
/// For each voxel it counts hits (scans with a return in it) and passages (other scans with a ray
/// that passed through its returns and ended 0.1 m or more behind them). A ray passes through
/// returns if it comes within 1.3 standard deviations of their mean, where the covariance is that
/// of the returns across the rays that brought them, with a prior of 0.05 m worth 0.7 returns: so a
/// ray beside a pole or past the edge of a desk, in the same voxel, is none, and nor is one that
/// ends on a floor it grazes (grazing_margins()). Nor does one count that comes within half a
/// second of a return there, or in the voxel beside it in x or y: what is thin is missed between
/// two hits, and poses that are a little off put it here now and there then. What moves is passed
/// by many rays before it comes and after it is gone.
///
/// The more scans, the more voxels beside surfaces have a return or two and are passed. What moves
/// is larger: a group of voxels that were passed, each among eight of them, or half of the voxels
/// around where these are fewer. Groups of fewer than 100 voxels count only where hardly anything
/// stands around them. To a group belong the voxels at its edge of which 0.3 passages come on each
/// hit of their own.
///
/// Give all scans to add_returns(), then all to add_rays(), both in their order, then decide().
/// Memory: about 70 bytes a voxel with a return, 1 kB for each 64^3 voxels, and the rays of
/// `seconds_together`. Same for any number of threads. Reading is thread safe.
class MovedReturns {
 public:
  /// Throws Error(usage) naming the option that is out of range.
  explicit MovedReturns(const MovedReturnsOptions& options = {});
  ~MovedReturns();

  void add_returns(const PlacedScan& scan);
  void add_rays(const PlacedScan& scan, ThreadPool& pool);
  void decide(ThreadPool& pool);

  /// Whether what was seen there [m] moved.
  bool moved(const Eigen::Vector3d& place) const;

  std::size_t voxels() const;        ///< with a return
  std::size_t moved_voxels() const;  ///< of these

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace kissmap
