// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cstdint>
#include <unordered_map>

#include "occupancy/tile.hpp"

namespace kissmap::occupancy {

/// Voxels that were hit, by tile.
using HitMasks = std::unordered_map<VoxelKey, TileMask>;

/// The hits in a tile and in those around it at its height.
class HitsAround {
 public:
  HitsAround(const Voxel& tile, const HitMasks& hits) {
    for (std::int32_t y = -1; y <= 1; ++y) {
      for (std::int32_t x = -1; x <= 1; ++x) {
        const auto found = hits.find(voxel_key({tile.x + x, tile.y + y, tile.z}));
        if (found != hits.end()) at(x, y) = &found->second;
      }
    }
  }

  /// Takes the voxels that were hit out of `open`, and those beside them: a thing that a pose a
  /// little off puts into the next voxel has not gone from this one.
  void leave_out(TileMask& open) const {
    for (std::int32_t z = 0; z < tile_side; ++z) {
      std::uint64_t before = widened(-1, z);
      std::uint64_t here = widened(0, z);
      for (std::int32_t y = 0; y < tile_side; ++y) {
        const std::uint64_t after = widened(y + 1, z);
        open[row_of(y, z)] &= ~(before | here | after);
        before = here;
        here = after;
      }
    }
  }

 private:
  const TileMask*& at(std::int32_t x, std::int32_t y) {
    const std::int32_t place = 3 * (y + 1) + x + 1;
    return masks_[static_cast<std::size_t>(place)];
  }

  /// Hits of a row, and those beside them in x. Row -1 is the last of the tile before.
  std::uint64_t widened(std::int32_t y, std::int32_t z) const {
    const std::size_t column = y < 0 ? 0 : y < tile_side ? 3 : 6;
    const std::uint32_t row = row_of(inside_tile(y), z);
    const auto hits = [&](std::size_t x) {
      const TileMask* mask = masks_[column + x];
      return mask == nullptr ? std::uint64_t{0} : (*mask)[row];
    };
    const std::uint64_t here = hits(1);
    return here | here << 1U | here >> 1U | hits(0) >> 63U | hits(2) << 63U;
  }

  std::array<const TileMask*, 9> masks_{};
};

}  // namespace kissmap::occupancy
