// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <vector>

#include "kissmap/occupancy/log_odds.hpp"
#include "occupancy/tile.hpp"

namespace kissmap::occupancy {

inline constexpr int block_bits = 3;
inline constexpr std::int32_t block_side = 1 << block_bits;
inline constexpr std::size_t block_voxels = 512;
inline constexpr std::int32_t blocks_per_side = tile_side / block_side;
inline constexpr std::size_t blocks_per_tile = 512;

/// Value of voxel (i,j,k) at i + 8 j + 64 k.
using BlockValues = std::array<LogOdds, block_voxels>;

struct TileCounts {
  std::uint64_t hits = 0;
  std::uint64_t misses = 0;
};

/// The beliefs of 64^3 voxels, in blocks of 8^3. A block whose voxels are all alike (unknown, or
/// free up to the clamp) needs no room of its own.
class OccupancyTile {
 public:
  OccupancyTile();

  /// One update of each voxel set in either mask; hits win.
  TileCounts update(const TileMask& misses, const TileMask& hits, const LogOddsSteps& steps);

  LogOdds at(std::int32_t x, std::int32_t y, std::int32_t z) const;

  /// Blocks numbered x + 8 y + 64 z. False if no voxel of the block is known.
  bool read_block(std::size_t block, BlockValues& values) const;
  std::size_t known_blocks() const;
  std::size_t memory_bytes() const;

 private:
  static constexpr std::size_t blocks_per_page = 8;
  using Page = std::array<BlockValues, blocks_per_page>;
  struct BlockMasks;

  void update_block(std::size_t block, const BlockMasks& masks, const LogOddsSteps& steps);
  BlockValues& stored(std::size_t place);
  const BlockValues& stored(std::size_t place) const;
  void store(std::size_t block, const BlockValues& values);
  void release(std::size_t block);

  /// uniform | the common value, or the place of the block among those stored.
  static constexpr std::uint16_t uniform = 0x8000;
  std::array<std::uint16_t, blocks_per_tile> directory_;
  std::vector<std::unique_ptr<Page>> pages_;
  std::vector<std::uint16_t> owners_;  ///< the block at each place, without gaps
};

}  // namespace kissmap::occupancy
