// SPDX-License-Identifier: MIT
#pragma once

#include <Eigen/Core>
#include <cmath>
#include <cstdint>

namespace kissmap {

/// Index of a cube of a voxel grid: voxel (i,j,k) covers [i v, (i+1) v) x [j v, (j+1) v) x ...
struct Voxel {
  std::int32_t x = 0;
  std::int32_t y = 0;
  std::int32_t z = 0;
  friend bool operator==(const Voxel&, const Voxel&) = default;
};

/// The voxel of a point. `per_metre` is 1 / voxel size. Valid while |coordinate| * per_metre <
/// 2^31.
inline Voxel voxel_of(const Eigen::Vector3f& point, float per_metre) {
  return {static_cast<std::int32_t>(std::floor(point.x() * per_metre)),
          static_cast<std::int32_t>(std::floor(point.y() * per_metre)),
          static_cast<std::int32_t>(std::floor(point.z() * per_metre))};
}

/// A voxel in 64 bits, 21 for each axis: one to one while |index| < 2^20 (524 km at 0.5 m).
using VoxelKey = std::uint64_t;
inline constexpr VoxelKey no_voxel = ~VoxelKey{0};

inline VoxelKey voxel_key(const Voxel& voxel) {
  constexpr std::uint64_t mask = (std::uint64_t{1} << 21U) - 1;
  return (static_cast<std::uint64_t>(voxel.x) & mask) |
         ((static_cast<std::uint64_t>(voxel.y) & mask) << 21U) |
         ((static_cast<std::uint64_t>(voxel.z) & mask) << 42U);
}

inline Voxel voxel_from_key(VoxelKey key) {
  const auto axis = [key](unsigned shift) {
    // Shift the 21 bits to the top and back, which copies their sign.
    return static_cast<std::int32_t>(static_cast<std::int64_t>(key << (43U - shift)) >> 43);
  };
  return {axis(0), axis(21), axis(42)};
}

/// Where a key starts looking in a table of 2^bits entries (Fibonacci hashing, Knuth vol. 3, 6.4).
inline std::size_t voxel_hash(VoxelKey key, unsigned bits) {
  return static_cast<std::size_t>((key * 0x9E3779B97F4A7C15ULL) >> (64U - bits));
}

}  // namespace kissmap
