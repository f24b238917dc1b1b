// SPDX-License-Identifier: MIT
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <unordered_map>
#include <vector>

#include "kissmap/occupancy/occupancy_geometry.hpp"
#include "kissmap/parallel/thread_pool.hpp"
#include "occupancy/hits_around.hpp"
#include "occupancy/scan_caster.hpp"
#include "occupancy/tile.hpp"

namespace kissmap::occupancy {

/// What was seen of one voxel.
struct Sighting {
  Eigen::Vector3f mean = Eigen::Vector3f::Zero();  ///< m, of its returns, from its centre
  /// xx xy xz yy yz zz: covariance of the returns across their rays [m2], later its inverse.
  std::array<float, 6> shape{};
  std::uint32_t returns = 0;
  std::uint16_t hits = 0;      ///< scans with a return in it
  std::uint16_t passages = 0;  ///< others of which a ray passed through them, see add_rays()
  bool passed = false;         ///< more often than hit, it and what is around
  bool in_group = false;       ///< passed, and much around it, too
  bool moved = false;
};

/// Sightings of all voxels with a return; see MovedReturns. First all returns are added, then
/// settle() is called, then all rays are added.
class Sightings {
 public:
  explicit Sightings(double voxel_size);

  void add_returns(const RayScan& scan);
  void settle(ThreadPool& pool);
  /// Scans of a short time. Where one of them hit a voxel or that beside it in x or y, a passage of
  /// another one does not count: what stands is often missed between two hits.
  void add_rays(std::span<const RayScan> together, ThreadPool& pool);

  const Sighting* at(const Voxel& voxel) const;  ///< null where there was no return
  Sighting* at(const Voxel& voxel);
  const OccupancyGeometry& geometry() const { return geometry_; }

  /// Calls body(voxel, sighting) for all, those of different tiles at the same time.
  void for_each(ThreadPool& pool, const std::function<void(const Voxel&, Sighting&)>& body);

 private:
  struct Place {
    std::size_t block, row;  ///< of the tile, of the block
    std::uint64_t bit;
  };
  struct Block {
    std::array<std::uint64_t, 8> rows{};  ///< bit i + 8 j of row k: voxel (i,j,k) has a return
    std::vector<Sighting> sightings;      ///< of these voxels, in order
    std::size_t rank(std::size_t row, std::uint64_t bit) const;
  };
  struct Tile {
    std::array<std::uint16_t, 512> blocks{};  ///< place of a block plus one; 0: no return
    std::vector<Block> stored;
    TileMask mask() const;
    Sighting& at(const Eigen::Vector3i& voxel);  ///< with a return, counted from the first
  };

  HitMasks hits_of(std::span<const RayScan> scans) const;
  static Place place_of(const Voxel& voxel);
  Sighting& sighting_at(const Voxel& voxel);
  /// Voxels of `open` through whose returns a ray passed.
  TileMask passages(const Voxel& first,
                    const TileWork& work,
                    std::span<const RayTrack> tracks,
                    const RayScan& scan,
                    Tile& tile,
                    TileMask open) const;
  void count(VoxelKey key,
             const TileWork& work,
             std::span<const RayTrack> tracks,
             const RayScan& scan,
             const HitMasks& hits_together,
             Tile& tile) const;
  Eigen::Matrix3f prior_at(const Voxel& voxel, const Sighting& sighting) const;
  bool passes_through(const Sighting& sighting,
                      const Eigen::Vector3f& centre,
                      const Eigen::Vector3f& direction,
                      float length) const;

  OccupancyGeometry geometry_;
  ScanCaster caster_;
  std::unordered_map<VoxelKey, std::unique_ptr<Tile>> tiles_;
};

}  // namespace kissmap::occupancy
