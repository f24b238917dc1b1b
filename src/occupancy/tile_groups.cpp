// SPDX-License-Identifier: MIT
#include "occupancy/tile_groups.hpp"

#include <algorithm>

namespace kissmap::occupancy {

void TileNumbers::clear() {
  std::ranges::fill(table_, Entry{});
  tiles_.clear();
  last_ = {};
}

std::uint32_t TileNumbers::add(VoxelKey tile, std::size_t slot) {
  last_ = {tile, static_cast<std::uint32_t>(tiles_.size())};
  tiles_.push_back(tile);
  table_[slot] = last_;
  if (2 * tiles_.size() > table_.size()) grow();
  return last_.number;
}

void TileNumbers::grow() {
  ++bits_;
  table_.assign(std::size_t{1} << bits_, Entry{});
  for (std::size_t i = 0; i < tiles_.size(); ++i) {
    std::size_t slot = voxel_hash(tiles_[i], bits_);
    while (table_[slot].tile != no_voxel) slot = (slot + 1) & (table_.size() - 1);
    table_[slot] = {tiles_[i], static_cast<std::uint32_t>(i)};
  }
}

}  // namespace kissmap::occupancy
