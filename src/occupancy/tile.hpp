// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cstdint>

#include "kissmap/cloud/voxel.hpp"

namespace kissmap::occupancy {

inline constexpr int tile_bits = 6;
inline constexpr std::int32_t tile_side = 1 << tile_bits;
inline constexpr std::int32_t tile_rows = tile_side * tile_side;

/// One bit for each voxel of a tile: bit x of word row_of(y, z).
using TileMask = std::array<std::uint64_t, tile_rows>;

/// Both at least 0 and below tile_side.
inline std::uint32_t row_of(std::int32_t y, std::int32_t z) {
  return static_cast<std::uint32_t>(z * tile_side + y);
}

inline Voxel tile_of(const Voxel& voxel) {
  return {voxel.x >> tile_bits, voxel.y >> tile_bits, voxel.z >> tile_bits};
}

inline std::int32_t inside_tile(std::int32_t index) {
  return index & (tile_side - 1);
}

/// Bits first..last of a word, 0 <= first <= last <= 63.
inline std::uint64_t bit_run(std::int32_t first, std::int32_t last) {
  return (~std::uint64_t{0} << first) & (~std::uint64_t{0} >> (63 - last));
}

}  // namespace kissmap::occupancy
