// SPDX-License-Identifier: MIT
#include "occupancy/occupancy_tile.hpp"

#include <algorithm>
#include <bit>
#include <cstring>

namespace kissmap::occupancy {
namespace {

constexpr std::uint16_t uniform_entry(LogOdds value) {
  return static_cast<std::uint16_t>(0x8000U | static_cast<std::uint8_t>(value));
}

constexpr LogOdds value_of(std::uint16_t entry) {
  return static_cast<LogOdds>(static_cast<std::uint8_t>(entry & 0xFFU));
}

/// Byte i of entry b is all ones if bit i of b is set.
constexpr std::array<std::uint64_t, 256> spread_bits = [] {
  std::array<std::uint64_t, 256> table{};
  for (std::size_t b = 0; b < 256; ++b) {
    for (unsigned i = 0; i < 8; ++i) {
      if ((b >> i & 1U) != 0) table[b] |= std::uint64_t{0xFF} << (8 * i);
    }
  }
  return table;
}();

using RowBytes = std::array<std::uint8_t, 64>;
using ByteMasks = std::array<LogOdds, block_voxels>;

ByteMasks spread(const RowBytes& rows) {
  ByteMasks bytes;
  for (std::size_t r = 0; r < rows.size(); ++r) {
    std::memcpy(bytes.data() + 8 * r, &spread_bits[rows[r]], 8);
  }
  return bytes;
}

LogOdds pick(LogOdds mask, LogOdds one, LogOdds other) {
  return static_cast<LogOdds>((mask & one) | (~mask & other));
}

// Written so that no sum leaves the range of LogOdds and the loops become vector code.
void apply_misses(const RowBytes& rows, const LogOddsSteps& steps, BlockValues& values) {
  const ByteMasks masks = spread(rows);
  const auto floor = static_cast<LogOdds>(steps.min + steps.miss);
  const LogOdds step = steps.miss;
  for (std::size_t i = 0; i < block_voxels; ++i) {
    const LogOdds old = values[i];
    const LogOdds known = old == unknown_log_odds ? LogOdds{0} : old;
    const auto next = static_cast<LogOdds>(std::max(known, floor) - step);
    values[i] = pick(masks[i], next, old);
  }
}

void apply_hits(const RowBytes& rows, const LogOddsSteps& steps, BlockValues& values) {
  const ByteMasks masks = spread(rows);
  const auto ceiling = static_cast<LogOdds>(steps.max - steps.hit);
  const LogOdds step = steps.hit;
  for (std::size_t i = 0; i < block_voxels; ++i) {
    const LogOdds old = values[i];
    const LogOdds known = old == unknown_log_odds ? LogOdds{0} : old;
    const auto next = static_cast<LogOdds>(std::min(known, ceiling) + step);
    values[i] = pick(masks[i], next, old);
  }
}

bool all_alike(const BlockValues& values) {
  return std::memcmp(values.data(), values.data() + 1, block_voxels - 1) == 0;
}

}  // namespace

struct OccupancyTile::BlockMasks {
  RowBytes misses;
  RowBytes hits;
  bool any_miss;
  bool any_hit;
};

OccupancyTile::OccupancyTile() {
  directory_.fill(uniform_entry(unknown_log_odds));
}

TileCounts OccupancyTile::update(const TileMask& misses,
                                 const TileMask& hits,
                                 const LogOddsSteps& steps) {
  TileCounts counts;
  // 64 neighbouring words are the rows of 8 blocks, of which byte b belongs to the b-th.
  for (std::size_t slab = 0; slab < blocks_per_tile / blocks_per_side; ++slab) {
    std::array<std::uint64_t, 64> missed;
    const std::size_t z = slab / blocks_per_side * block_side;
    const std::size_t y = slab % blocks_per_side * block_side;
    std::array<std::uint64_t, 64> hit;
    std::uint64_t any_miss = 0;
    std::uint64_t any_hit = 0;
    for (std::size_t r = 0; r < 64; ++r) {
      const std::size_t row = (z + r / 8) * tile_side + y + r % 8;
      hit[r] = hits[row];
      missed[r] = misses[row] & ~hits[row];
      any_hit |= hit[r];
      any_miss |= missed[r];
    }
    if ((any_miss | any_hit) == 0) continue;
    for (std::size_t r = 0; r < 64; ++r) {
      counts.hits += static_cast<std::uint64_t>(std::popcount(hit[r]));
      counts.misses += static_cast<std::uint64_t>(std::popcount(missed[r]));
    }
    for (std::size_t b = 0; b < blocks_per_side; ++b) {
      BlockMasks masks;
      masks.any_miss = (any_miss >> (8 * b) & 0xFFU) != 0;
      masks.any_hit = (any_hit >> (8 * b) & 0xFFU) != 0;
      if (!masks.any_miss && !masks.any_hit) continue;
      for (std::size_t r = 0; r < 64; ++r) {
        masks.misses[r] = static_cast<std::uint8_t>(missed[r] >> (8 * b));
        masks.hits[r] = static_cast<std::uint8_t>(hit[r] >> (8 * b));
      }
      update_block(slab * blocks_per_side + b, masks, steps);
    }
  }
  return counts;
}

void OccupancyTile::update_block(std::size_t block,
                                 const BlockMasks& masks,
                                 const LogOddsSteps& steps) {
  const std::uint16_t entry = directory_[block];
  if (entry == uniform_entry(steps.min) && !masks.any_hit) return;
  const bool was_uniform = entry >= uniform;
  BlockValues expanded;
  if (was_uniform) expanded.fill(value_of(entry));
  BlockValues& values = was_uniform ? expanded : stored(entry);
  if (masks.any_miss) apply_misses(masks.misses, steps, values);
  if (masks.any_hit) apply_hits(masks.hits, steps, values);
  if (all_alike(values)) {
    const LogOdds value = values[0];
    if (!was_uniform) release(block);
    directory_[block] = uniform_entry(value);
  } else if (was_uniform) {
    store(block, values);
  }
}

BlockValues& OccupancyTile::stored(std::size_t place) {
  return (*pages_[place / blocks_per_page])[place % blocks_per_page];
}

const BlockValues& OccupancyTile::stored(std::size_t place) const {
  return (*pages_[place / blocks_per_page])[place % blocks_per_page];
}

void OccupancyTile::store(std::size_t block, const BlockValues& values) {
  const std::size_t place = owners_.size();
  if (place == pages_.size() * blocks_per_page) pages_.push_back(std::make_unique<Page>());
  stored(place) = values;
  owners_.push_back(static_cast<std::uint16_t>(block));
  directory_[block] = static_cast<std::uint16_t>(place);
}

void OccupancyTile::release(std::size_t block) {
  const std::size_t place = directory_[block];
  const std::size_t last = owners_.size() - 1;
  if (place != last) {
    stored(place) = stored(last);
    owners_[place] = owners_[last];
    directory_[owners_[place]] = static_cast<std::uint16_t>(place);
  }
  owners_.pop_back();
  if (owners_.size() + blocks_per_page == pages_.size() * blocks_per_page) pages_.pop_back();
}

LogOdds OccupancyTile::at(std::int32_t x, std::int32_t y, std::int32_t z) const {
  const std::int32_t block =
      ((z >> block_bits) * blocks_per_side + (y >> block_bits)) * blocks_per_side +
      (x >> block_bits);
  const std::uint16_t entry = directory_[static_cast<std::size_t>(block)];
  if (entry >= uniform) return value_of(entry);
  constexpr std::int32_t low = block_side - 1;
  const std::int32_t voxel = ((z & low) * block_side + (y & low)) * block_side + (x & low);
  return stored(entry)[static_cast<std::size_t>(voxel)];
}

bool OccupancyTile::read_block(std::size_t block, BlockValues& values) const {
  const std::uint16_t entry = directory_[block];
  if (entry == uniform_entry(unknown_log_odds)) return false;
  if (entry >= uniform) {
    values.fill(value_of(entry));
  } else {
    values = stored(entry);
  }
  return true;
}

std::size_t OccupancyTile::known_blocks() const {
  return blocks_per_tile -
         static_cast<std::size_t>(std::ranges::count(directory_, uniform_entry(unknown_log_odds)));
}

std::size_t OccupancyTile::memory_bytes() const {
  return sizeof(*this) + pages_.capacity() * sizeof(pages_[0]) + pages_.size() * sizeof(Page) +
         owners_.capacity() * sizeof(owners_[0]);
}

}  // namespace kissmap::occupancy
