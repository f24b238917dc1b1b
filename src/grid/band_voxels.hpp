// SPDX-License-Identifier: MIT
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <unordered_map>
#include <vector>

#include "kissmap/cloud/voxel.hpp"
#include "kissmap/grid/grid_map.hpp"
#include "kissmap/occupancy/log_odds.hpp"
#include "kissmap/parallel/thread_pool.hpp"

namespace kissmap {

/// A straight piece of a ray in the frame of the band: x, y in cells, z in layers.
struct BandPiece {
  Eigen::Vector3d from;
  Eigen::Vector3d to;
};

/// What one scan says of the band: pieces of rays that saw nothing, and places of hits.
struct BandScan {
  std::vector<BandPiece> free;
  std::vector<Eigen::Vector3d> hits;
};

/// Log-odds of the voxels of a band: columns of `layers` voxels, in tiles of 16 x 16 columns.
/// Memory is one byte a voxel of the tiles that rays have met.
class BandVoxels {
 public:
  BandVoxels(int layers, const LogOddsOptions& options);

  /// Takes in one scan, given in parts by threads: each voxel is changed once, and a hit in it wins
  /// over all rays through it.
  void add(std::span<const BandScan> parts, ThreadPool& pool);

  /// A column of each cell seen, judged; the map covers whole tiles.
  GridMap grid(double resolution, const ColumnRule& rule) const;

  std::size_t memory_bytes() const;

 private:
  static constexpr int tile_cells = 16;

  struct Tile {
    std::int32_t x = 0;
    std::int32_t y = 0;
    std::vector<LogOdds> voxels;
  };
  /// A bit for each voxel of a tile; each column begins a word.
  using Mask = std::vector<std::uint64_t>;
  class Marks;

  std::size_t tile_voxels() const;
  LogOdds updated(LogOdds before, bool hit) const;
  Tile& tile(VoxelKey key);
  void apply(const Mask& hits, const Mask& misses, Tile& tile) const;

  int layers_;
  LogOddsSteps steps_;
  std::vector<Tile> tiles_;  ///< in the order they were met
  std::unordered_map<VoxelKey, std::size_t> places_;
};

}  // namespace kissmap
