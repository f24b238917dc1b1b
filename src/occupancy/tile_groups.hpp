// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "kissmap/cloud/voxel.hpp"

namespace kissmap::occupancy {

/// Numbers tiles in the order in which they are first asked for.
class TileNumbers {
 public:
  TileNumbers() : table_(std::size_t{1} << bits_) {}

  std::uint32_t number(VoxelKey tile) {
    if (tile == last_.tile) return last_.number;
    std::size_t slot = voxel_hash(tile, bits_);
    while (table_[slot].tile != tile) {
      if (table_[slot].tile == no_voxel) return add(tile, slot);
      slot = (slot + 1) & (table_.size() - 1);
    }
    last_ = table_[slot];
    return last_.number;
  }

  const std::vector<VoxelKey>& tiles() const { return tiles_; }
  void clear();

 private:
  struct Entry {
    VoxelKey tile = no_voxel;
    std::uint32_t number = 0;
  };
  std::uint32_t add(VoxelKey tile, std::size_t slot);
  void grow();

  unsigned bits_ = 8;
  std::vector<Entry> table_;  ///< open addressing, linear probing, at most half full
  std::vector<VoxelKey> tiles_;
  Entry last_;
};

/// Items gathered by tile, in the order added within each.
template <class Item>
class TileGroups {
 public:
  void clear() {
    numbers_.clear();
    items_.clear();
    item_tiles_.clear();
  }

  void add(VoxelKey tile, const Item& item) {
    item_tiles_.push_back(numbers_.number(tile));
    items_.push_back(item);
  }

  /// To be called once after the last add().
  void gather() {
    begins_.assign(tiles().size() + 1, 0);
    for (const std::uint32_t tile : item_tiles_) ++begins_[tile + 1];
    for (std::size_t t = 1; t < begins_.size(); ++t) begins_[t] += begins_[t - 1];
    gathered_.resize(items_.size());
    for (std::size_t i = 0; i < items_.size(); ++i) {
      gathered_[begins_[item_tiles_[i]]++] = items_[i];
    }
    for (std::size_t t = begins_.size() - 1; t > 0; --t) begins_[t] = begins_[t - 1];
    begins_[0] = 0;
  }

  const std::vector<VoxelKey>& tiles() const { return numbers_.tiles(); }
  std::span<const Item> of_tile(std::size_t number) const {
    return std::span(gathered_).subspan(begins_[number], begins_[number + 1] - begins_[number]);
  }

 private:
  TileNumbers numbers_;
  std::vector<Item> items_;
  std::vector<std::uint32_t> item_tiles_;
  std::vector<std::uint32_t> begins_;
  std::vector<Item> gathered_;
};

}  // namespace kissmap::occupancy
