// SPDX-License-Identifier: MIT
#include "kissmap/occupancy/occupancy_map.hpp"

#include <algorithm>
#include <tuple>
#include <unordered_map>
#include <vector>

#include "occupancy/occupancy_tile.hpp"
#include "occupancy/scan_caster.hpp"

namespace kissmap {

using occupancy::BlockValues;
using occupancy::OccupancyTile;
using occupancy::TileMask;
using occupancy::TileWork;

static_assert(occupancy_block_side == occupancy::block_side);
static_assert(occupancy_tile_side == occupancy::tile_side);

class OccupancyMap::Tiles {
 public:
  Tiles(const OccupancyGeometry& geometry, const OccupancyOptions& options)
      : caster(geometry, options) {}

  OccupancyTile& get(VoxelKey key) {
    auto& tile = tiles[key];
    if (tile == nullptr) tile = std::make_unique<OccupancyTile>();
    return *tile;
  }

  std::vector<std::pair<Voxel, const OccupancyTile*>> in_order() const {
    std::vector<std::pair<Voxel, const OccupancyTile*>> sorted;
    sorted.reserve(tiles.size());
    for (const auto& [key, tile] : tiles) sorted.emplace_back(voxel_from_key(key), tile.get());
    std::ranges::sort(sorted, {}, [](const auto& entry) {
      return std::tuple(entry.first.z, entry.first.y, entry.first.x);
    });
    return sorted;
  }

  occupancy::ScanCaster caster;
  std::unordered_map<VoxelKey, std::unique_ptr<OccupancyTile>> tiles;
};

OccupancyMap::OccupancyMap(const OccupancyGeometry& geometry, const OccupancyOptions& options)
    : geometry_(geometry), options_(options), steps_(LogOddsSteps::from(options.log_odds)) {
  require_valid(geometry);
  tiles_ = std::make_unique<Tiles>(geometry, options);
}

OccupancyMap::~OccupancyMap() = default;
OccupancyMap::OccupancyMap(OccupancyMap&&) noexcept = default;
OccupancyMap& OccupancyMap::operator=(OccupancyMap&&) noexcept = default;

OccupancyUpdate OccupancyMap::add(const RayScan& scan, ThreadPool& pool) {
  occupancy::TileCounts total;
  const auto work = [&](std::span<const TileWork> tiles,
                        std::span<const occupancy::RayTrack> tracks) {
    std::vector<OccupancyTile*> targets;
    for (const TileWork& tile : tiles) {
      const bool kept = box_.contains(voxel_from_key(tile.tile));
      targets.push_back(kept ? &tiles_->get(tile.tile) : nullptr);
    }
    std::vector<occupancy::TileCounts> counts(tiles.size());
    pool.for_each_chunk(tiles.size(), [&](std::size_t i) {
      if (targets[i] == nullptr) return;
      TileMask hits{};
      TileMask misses{};
      tiles[i].mark_hits(hits);
      tiles[i].mark_misses(tracks, misses);
      counts[i] = targets[i]->update(misses, hits, steps_);
    });
    for (const occupancy::TileCounts& c : counts) {
      total.hits += c.hits;
      total.misses += c.misses;
    }
  };
  OccupancyUpdate update = tiles_->caster.cast(scan, box_, pool, work);
  update.hit_voxels = total.hits;
  update.missed_voxels = total.misses;
  return update;
}

void OccupancyMap::restrict_to(const TileBox& box) {
  box_ = intersection(box_, box);
  std::erase_if(tiles_->tiles,
                [this](const auto& entry) { return !box_.contains(voxel_from_key(entry.first)); });
}

void OccupancyMap::start_over(const TileBox& box) {
  tiles_->tiles.clear();
  box_ = box;
}

std::vector<Voxel> OccupancyMap::tiles() const {
  std::vector<Voxel> numbers;
  for (const auto& [place, tile] : tiles_->in_order()) numbers.push_back(place);
  return numbers;
}

LogOdds OccupancyMap::at(const Voxel& voxel) const {
  const auto mappable = [](std::int32_t i) { return i > -max_voxel_index && i < max_voxel_index; };
  if (!mappable(voxel.x) || !mappable(voxel.y) || !mappable(voxel.z)) return unknown_log_odds;
  const auto found = tiles_->tiles.find(voxel_key(occupancy::tile_of(voxel)));
  if (found == tiles_->tiles.end()) return unknown_log_odds;
  using occupancy::inside_tile;
  return found->second->at(inside_tile(voxel.x), inside_tile(voxel.y), inside_tile(voxel.z));
}

void OccupancyMap::for_each_block(const std::function<void(const OccupancyBlock&)>& body) const {
  BlockValues values;
  for (const auto& [place, tile] : tiles_->in_order()) {
    for (std::size_t block = 0; block < occupancy::blocks_per_tile; ++block) {
      if (!tile->read_block(block, values)) continue;
      const auto b = static_cast<std::int32_t>(block);
      const Voxel first{place.x * occupancy::tile_side + b % 8 * occupancy_block_side,
                        place.y * occupancy::tile_side + b / 8 % 8 * occupancy_block_side,
                        place.z * occupancy::tile_side + b / 64 * occupancy_block_side};
      body({first, values});
    }
  }
}

void OccupancyMap::for_each_voxel(const std::function<void(const Voxel&, LogOdds)>& body) const {
  for_each_block([&body](const OccupancyBlock& block) {
    for (std::int32_t i = 0; i < 512; ++i) {
      const LogOdds value = block.values[static_cast<std::size_t>(i)];
      if (value == unknown_log_odds) continue;
      body({block.first.x + i % 8, block.first.y + i / 8 % 8, block.first.z + i / 64}, value);
    }
  });
}

std::size_t OccupancyMap::block_count() const {
  std::size_t count = 0;
  for (const auto& entry : tiles_->tiles) count += entry.second->known_blocks();
  return count;
}

std::size_t OccupancyMap::memory_bytes() const {
  constexpr std::size_t node =
      sizeof(void*) + sizeof(VoxelKey) + sizeof(void*) + sizeof(std::size_t);
  std::size_t bytes = sizeof(*this) + tiles_->tiles.bucket_count() * sizeof(void*);
  for (const auto& entry : tiles_->tiles) bytes += node + entry.second->memory_bytes();
  return bytes;
}

}  // namespace kissmap
