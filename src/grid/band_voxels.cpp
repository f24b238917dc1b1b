// SPDX-License-Identifier: MIT
#include "grid/band_voxels.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>

namespace kissmap {
namespace {

/// Walks the voxels of a piece in order (Amanatides and Woo, Eurographics 1987). Calls with x, y,
/// z.
template <typename Call>
void walk(const BandPiece& piece, int layers, const Call& call) {
  Eigen::Vector3d from = piece.from;
  const Eigen::Vector3d way = piece.to - piece.from;
  // Only the part between the lowest and the highest layer.
  double begin = 0.0;
  double end = 1.0;
  const double top = layers;
  if (way.z() == 0.0) {
    if (from.z() < 0.0 || from.z() >= top) return;
  } else {
    const double low = -from.z() / way.z();
    const double high = (top - from.z()) / way.z();
    begin = std::max(begin, std::min(low, high));
    end = std::min(end, std::max(low, high));
    if (begin >= end) return;
  }
  const Eigen::Vector3d first = from + begin * way;
  const Eigen::Vector3d last = from + end * way;
  std::array<int, 3> voxel{};
  std::array<int, 3> step{};
  std::array<double, 3> next{};    // share of the way at which the voxel changes along this axis
  std::array<double, 3> across{};  // share of the way through one voxel
  int steps = 0;
  for (int axis = 0; axis < 3; ++axis) {
    const auto a = static_cast<std::size_t>(axis);
    voxel[a] = static_cast<int>(std::floor(first[axis]));
    int stop = static_cast<int>(std::floor(last[axis]));
    if (axis == 2) {
      voxel[a] = std::clamp(voxel[a], 0, layers - 1);
      stop = std::clamp(stop, 0, layers - 1);
    }
    step[a] = stop > voxel[a] ? 1 : -1;
    steps += std::abs(stop - voxel[a]);
    const bool moves = stop != voxel[a];
    const int border = step[a] > 0 ? voxel[a] + 1 : voxel[a];
    next[a] = moves ? (border - from[axis]) / way[axis] : std::numeric_limits<double>::infinity();
    across[a] = moves ? step[a] / way[axis] : 0.0;
  }
  call(voxel[0], voxel[1], voxel[2]);
  for (int i = 0; i < steps; ++i) {
    const std::size_t a =
        next[0] < next[1] ? (next[0] < next[2] ? 0 : 2) : (next[1] < next[2] ? 1 : 2);
    voxel[a] += step[a];
    next[a] += across[a];
    if (voxel[2] < 0 || voxel[2] >= layers) return;
    call(voxel[0], voxel[1], voxel[2]);
  }
}

std::int32_t tile_of(int cell) {
  return cell >> 4;
}

}  // namespace

/// The voxels one part of a scan hits and passes.
class BandVoxels::Marks {
 public:
  struct TileMarks {
    Mask hits;
    Mask misses;
  };

  Marks(int layers, std::size_t words) : layers_(layers), words_(words) {}

  void mark(const BandScan& part) {
    for (const BandPiece& piece : part.free) {
      walk(piece, layers_, [this](int x, int y, int z) { set(tile(x, y).misses, x, y, z); });
    }
    for (const Eigen::Vector3d& hit : part.hits) {
      if (hit.z() < 0.0 || hit.z() >= layers_) continue;
      const auto x = static_cast<int>(std::floor(hit.x()));
      const auto y = static_cast<int>(std::floor(hit.y()));
      set(tile(x, y).hits, x, y, static_cast<int>(hit.z()));
    }
  }

  std::unordered_map<VoxelKey, TileMarks>& tiles() { return tiles_; }

 private:
  TileMarks& tile(int x, int y) {
    const Voxel at{tile_of(x), tile_of(y), 0};
    if (latest_ != nullptr && at == latest_at_) return *latest_;
    TileMarks& marks = tiles_[voxel_key(at)];
    if (marks.hits.empty()) {
      marks.hits.assign(words_, 0);
      marks.misses.assign(words_, 0);
    }
    latest_ = &marks;
    latest_at_ = at;
    return marks;
  }

  void set(Mask& mask, int x, int y, int z) const {
    const auto column =
        static_cast<std::size_t>((y & (tile_cells - 1)) * tile_cells + (x & (tile_cells - 1)));
    const std::size_t voxel =
        column * static_cast<std::size_t>(layers_) + static_cast<std::size_t>(z);
    mask[voxel / 64] |= std::uint64_t{1} << (voxel % 64);
  }

  int layers_;
  std::size_t words_;
  std::unordered_map<VoxelKey, TileMarks> tiles_;
  TileMarks* latest_ = nullptr;
  Voxel latest_at_;
};

BandVoxels::BandVoxels(int layers, const OccupancyOptions& options)
    : layers_(layers), model_((require_valid(options), options)) {
}

std::size_t BandVoxels::tile_voxels() const {
  return static_cast<std::size_t>(tile_cells * tile_cells) * static_cast<std::size_t>(layers_);
}

BandVoxels::Tile& BandVoxels::tile(VoxelKey key) {
  const auto [place, added] = places_.try_emplace(key, tiles_.size());
  if (added) {
    const Voxel at = voxel_from_key(key);
    tiles_.push_back({at.x, at.y, std::vector<LogOdds>(tile_voxels(), never_seen)});
  }
  return tiles_[place->second];
}

void BandVoxels::apply(const Mask& hits, const Mask& misses, Tile& tile) const {
  for (std::size_t word = 0; word < hits.size(); ++word) {
    std::uint64_t changed = hits[word] | misses[word];
    while (changed != 0) {
      const auto bit = static_cast<std::size_t>(std::countr_zero(changed));
      changed &= changed - 1;
      LogOdds& voxel = tile.voxels[word * 64 + bit];
      const bool hit = (hits[word] >> bit & 1U) != 0;
      voxel = hit ? model_.after_hit(voxel) : model_.after_miss(voxel);
    }
  }
}

void BandVoxels::add(std::span<const BandScan> parts, ThreadPool& pool) {
  const std::size_t words = (tile_voxels() + 63) / 64;
  std::vector<Marks> marks(parts.size(), Marks(layers_, words));
  pool.for_each_chunk(parts.size(), [&](std::size_t i) { marks[i].mark(parts[i]); });
  if (marks.empty()) return;
  auto& all = marks.front().tiles();
  for (std::size_t i = 1; i < marks.size(); ++i) {
    for (auto& [key, from] : marks[i].tiles()) {
      const auto [to, added] = all.try_emplace(key, std::move(from));
      if (added) continue;
      for (std::size_t word = 0; word < words; ++word) {
        to->second.hits[word] |= from.hits[word];
        to->second.misses[word] |= from.misses[word];
      }
    }
  }
  for (const auto& [key, tile_marks] : all) apply(tile_marks.hits, tile_marks.misses, tile(key));
}

GridMap BandVoxels::grid(double resolution, const ColumnRule& rule) const {
  GridMap map;
  map.resolution = resolution;
  if (tiles_.empty()) return map;
  const auto [low_x, high_x] = std::ranges::minmax(tiles_, {}, &Tile::x);
  const auto [low_y, high_y] = std::ranges::minmax(tiles_, {}, &Tile::y);
  const int first_x = low_x.x * tile_cells;
  const int first_y = low_y.y * tile_cells;
  map.corner = Eigen::Vector2d(first_x, first_y) * resolution;
  map.width = (high_x.x + 1) * tile_cells - first_x;
  map.height = (high_y.y + 1) * tile_cells - first_y;
  map.cells.resize(static_cast<std::size_t>(map.width) * static_cast<std::size_t>(map.height));
  std::vector<float> column(static_cast<std::size_t>(layers_));
  for (const Tile& tile : tiles_) {
    for (int cell = 0; cell < tile_cells * tile_cells; ++cell) {
      const auto begin = static_cast<std::size_t>(cell) * column.size();
      for (std::size_t layer = 0; layer < column.size(); ++layer) {
        column[layer] = LogOddsModel::probability(tile.voxels[begin + layer]);
      }
      map.at(tile.x * tile_cells + cell % tile_cells - first_x,
             tile.y * tile_cells + cell / tile_cells - first_y) = judge_column(column, rule);
    }
  }
  return map;
}

std::size_t BandVoxels::memory_bytes() const {
  return tiles_.size() * (tile_voxels() + sizeof(Tile));
}

}  // namespace kissmap
