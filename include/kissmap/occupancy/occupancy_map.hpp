// SPDX-License-Identifier: MIT
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <vector>

#include "kissmap/occupancy/log_odds.hpp"
#include "kissmap/occupancy/occupancy_geometry.hpp"
#include "kissmap/occupancy/tile_box.hpp"
#include "kissmap/parallel/thread_pool.hpp"

namespace kissmap {

/// The rays of one scan. The arrays run parallel or, where said, are empty.
/// Positions are relative to `offset`: floats keep 4 micrometres at 60 m whatever the place.
/// A ray bent by a change of frame is given as several rays of which only the last is a hit.
struct RayScan {
  Eigen::Vector3d offset = Eigen::Vector3d::Zero();  ///< m, in the frame of the map
  std::span<const Eigen::Vector3f> starts;  ///< m, where the sensor was when each end was seen
  std::span<const Eigen::Vector3f> ends;    ///< m
  std::span<const std::uint8_t> is_hit;     ///< 0: nothing was met at the end; empty: all are hits
  /// m before the end within which the ray carves nothing, NaN read as infinite; for hits and for
  /// others. Empty: `margin` for hits, 0 for others. See grazing_margins().
  std::span<const float> margins;
  double margin = 0.0;  ///< m, >= 0
};

struct OccupancyOptions {
  LogOddsOptions log_odds;
  /// Of the hits that share an end voxel only the first is cast. Faster, less exact: OctoMap's
  /// "discretize", and what Bonxai does.
  bool one_ray_per_end_voxel = false;
  /// Working memory of add(), roughly [bytes]. Scans that need more are cast in several passes.
  std::size_t scratch_bytes = std::size_t{256} << 20U;
};

/// What one scan did. Rays are counted once; those counted as skipped did nothing.
struct OccupancyUpdate {
  std::uint64_t rays = 0;        ///< all that were given
  std::uint64_t non_finite = 0;  ///< skipped: NaN or infinite
  std::uint64_t too_far = 0;     ///< skipped: beyond max_voxel_index, or 2^20 voxels long
  std::uint64_t thinned = 0;  ///< their end was marked but nothing carved, by one_ray_per_end_voxel
  std::uint64_t hit_voxels = 0;
  std::uint64_t missed_voxels = 0;
};

/// Voxels along each side of a block.
inline constexpr std::int32_t occupancy_block_side = 8;

/// 8 x 8 x 8 neighbouring voxels. `values[i + 8 j + 64 k]` belongs to `first` + (i,j,k).
struct OccupancyBlock {
  Voxel first;
  std::span<const LogOdds, 512> values;
};

/// A 3D occupancy map: log-odds of voxels, updated scan by scan along rays.
///
/// One update a voxel and scan, whatever number of rays meet there: a hit if a ray that is a hit
/// ends in it, else a miss if any ray carves it. A ray carves the voxels it leaves before its
/// margin begins, each of them (exact traversal, Amanatides and Woo 1987; a voxel touched over less
/// than 1e-6 of its size may go either way); a ray that is no hit and has no margin also carves the
/// voxel it ends in. So a hit never carves its own end voxel, and rays of the same scan cannot
/// erase each other's hits.
///
/// Rays are cut into pieces by tiles of 64^3 voxels and gathered tile by tile, so that a voxel
/// costs one bit in a cached mask and each block of beliefs is read and written once a scan.
/// Runs of voxels along x are one operation.
///
/// Content and memory are the same for any number of threads, and for scratch_bytes of any size.
///
/// Memory: a block of 8^3 voxels takes 514 bytes, or none while all its voxels hold the same
/// belief, as open space does once clamped; a tile takes 1.2 kB and at most 4 kB of slack. Where
/// everything up to h metres was seen and nothing is alike, voxels of v metres take 1.03 h / v^3
/// bytes a square metre, counting blocks and tiles that reach beyond as seen. That is the bound:
/// 1.3 kB for 10 m at 0.2 m, 82 kB at 0.05 m. A hall of that height took 0.84 kB and 81.5 kB.
/// add() works with scratch_bytes and about 100 bytes a ray.
///
/// Reading is thread safe; add() excludes reading.
class OccupancyMap {
 public:
  /// Throws Error(usage) naming the field.
  explicit OccupancyMap(const OccupancyGeometry& geometry, const OccupancyOptions& options = {});
  ~OccupancyMap();
  OccupancyMap(OccupancyMap&&) noexcept;
  OccupancyMap& operator=(OccupancyMap&&) noexcept;

  /// Throws Error(internal) if arrays differ in length or the margin is negative or NaN.
  OccupancyUpdate add(const RayScan& scan, ThreadPool& pool);

  /// Keeps this part of the map, of what an earlier call kept: frees all tiles outside. From then
  /// on rays leave no trace there, and the part becomes what it would have become in the whole map.
  void restrict_to(const TileBox& box);
  /// Forgets all that was seen; from then on this part is kept and no other.
  void start_over(const TileBox& box);
  /// Numbers of the tiles that take memory, by z, y, x.
  std::vector<Voxel> tiles() const;

  LogOdds at(const Voxel& voxel) const;  ///< unknown_log_odds where nothing was seen
  bool is_occupied(const Voxel& voxel) const { return steps_.is_occupied(at(voxel)); }
  bool is_free(const Voxel& voxel) const { return steps_.is_free(at(voxel)); }

  /// Every block with a known voxel once, in an order that depends on the content alone: by z, y, x
  /// of tiles, then of blocks.
  void for_each_block(const std::function<void(const OccupancyBlock&)>& body) const;
  /// Every known voxel once, in that order.
  void for_each_voxel(const std::function<void(const Voxel&, LogOdds)>& body) const;

  std::size_t block_count() const;   ///< with a known voxel
  std::size_t memory_bytes() const;  ///< of the map, without what add() works with

  const OccupancyGeometry& geometry() const { return geometry_; }
  const LogOddsSteps& steps() const { return steps_; }

 private:
  class Tiles;
  OccupancyGeometry geometry_;
  OccupancyOptions options_;
  LogOddsSteps steps_;
  TileBox box_;
  std::unique_ptr<Tiles> tiles_;
};

}  // namespace kissmap
