// SPDX-License-Identifier: MIT
#include "grid/band_voxels.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>

namespace kissmap {
namespace {

/// The part of a piece between the lowest and the highest layer, as shares of its way.
struct Part {
  double begin = 0.0;
  double end = 1.0;
};

Part inside_layers(const BandPiece& piece, int layers) {
  const double from = piece.from.z();
  const double way = piece.to.z() - from;
  const double top = layers;
  if (way == 0.0) return from < 0.0 || from >= top ? Part{1.0, 0.0} : Part{};
  const double low = -from / way;
  const double high = (top - from) / way;
  return {std::max(0.0, std::min(low, high)), std::min(1.0, std::max(low, high))};
}

/// Walks the columns of a piece in order (Amanatides and Woo, Eurographics 1987). Calls with x, y
/// and the lowest and the highest layer that the piece passes in that column.
template <typename Call>
void walk(const BandPiece& piece, int layers, const Call& call) {
  const auto [begin, end] = inside_layers(piece, layers);
  if (!(begin < end)) return;
  const Eigen::Vector3d way = piece.to - piece.from;
  const auto layer_at = [&](double share) {
    return std::clamp(static_cast<int>(piece.from.z() + share * way.z()), 0, layers - 1);
  };
  std::array<int, 2> cell{};
  std::array<int, 2> step{};
  std::array<double, 2> next{};    // share of the way at which the cell changes along this axis
  std::array<double, 2> across{};  // share of the way through one cell
  int steps = 0;
  for (int axis = 0; axis < 2; ++axis) {
    const auto a = static_cast<std::size_t>(axis);
    cell[a] = static_cast<int>(std::floor(piece.from[axis] + begin * way[axis]));
    const int stop = static_cast<int>(std::floor(piece.from[axis] + end * way[axis]));
    step[a] = stop > cell[a] ? 1 : -1;
    steps += std::abs(stop - cell[a]);
    const bool moves = stop != cell[a];
    const int border = step[a] > 0 ? cell[a] + 1 : cell[a];
    next[a] =
        moves ? (border - piece.from[axis]) / way[axis] : std::numeric_limits<double>::infinity();
    across[a] = moves ? step[a] / way[axis] : 0.0;
  }
  int layer = layer_at(begin);
  for (; steps > 0; --steps) {
    const std::size_t a = next[0] < next[1] ? 0 : 1;
    const int beyond = layer_at(std::min(next[a], end));
    call(cell[0], cell[1], std::min(layer, beyond), std::max(layer, beyond));
    layer = beyond;
    cell[a] += step[a];
    next[a] += across[a];
  }
  const int last = layer_at(end);
  call(cell[0], cell[1], std::min(layer, last), std::max(layer, last));
}

/// Words of 64 bits that hold a column.
std::size_t words_of(int layers) {
  return (static_cast<std::size_t>(layers) + 63) / 64;
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

  explicit Marks(int layers) : layers_(layers), words_(words_of(layers)) {}

  void mark(const BandScan& part) {
    for (const BandPiece& piece : part.free) {
      walk(piece, layers_, [this](int x, int y, int low, int high) {
        set(&tile(x, y).misses[first_word(x, y)], low, high);
      });
    }
    for (const Eigen::Vector3d& hit : part.hits) {
      if (!(hit.z() >= 0.0 && hit.z() < layers_)) continue;
      const auto x = static_cast<int>(std::floor(hit.x()));
      const auto y = static_cast<int>(std::floor(hit.y()));
      const auto layer = static_cast<int>(hit.z());
      set(&tile(x, y).hits[first_word(x, y)], layer, layer);
    }
  }

  std::unordered_map<VoxelKey, TileMarks>& tiles() { return tiles_; }

 private:
  TileMarks& tile(int x, int y) {
    const Voxel at{tile_of(x), tile_of(y), 0};
    if (latest_ != nullptr && at == latest_at_) return *latest_;
    TileMarks& marks = tiles_[voxel_key(at)];
    if (marks.hits.empty()) {
      marks.hits.assign(words_ * tile_cells * tile_cells, 0);
      marks.misses.assign(words_ * tile_cells * tile_cells, 0);
    }
    latest_ = &marks;
    latest_at_ = at;
    return marks;
  }

  std::size_t first_word(int x, int y) const {
    return words_ *
           static_cast<std::size_t>((y & (tile_cells - 1)) * tile_cells + (x & (tile_cells - 1)));
  }

  /// Sets the bits of layers low..high of a column.
  static void set(std::uint64_t* column, int low, int high) {
    for (int word = low / 64; word <= high / 64; ++word) {
      const int first = std::max(low - 64 * word, 0);
      const int last = std::min(high - 64 * word, 63);
      column[word] |= (~std::uint64_t{0} << first) & (~std::uint64_t{0} >> (63 - last));
    }
  }

  int layers_;
  std::size_t words_;
  std::unordered_map<VoxelKey, TileMarks> tiles_;
  TileMarks* latest_ = nullptr;
  Voxel latest_at_;
};

BandVoxels::BandVoxels(int layers, const LogOddsOptions& options)
    : layers_(layers), steps_(LogOddsSteps::from(options)) {
}

std::size_t BandVoxels::tile_voxels() const {
  return static_cast<std::size_t>(tile_cells * tile_cells) * static_cast<std::size_t>(layers_);
}

BandVoxels::Tile& BandVoxels::tile(VoxelKey key) {
  const auto [place, added] = places_.try_emplace(key, tiles_.size());
  if (added) {
    const Voxel at = voxel_from_key(key);
    tiles_.push_back({at.x, at.y, std::vector<LogOdds>(tile_voxels(), unknown_log_odds)});
  }
  return tiles_[place->second];
}

LogOdds BandVoxels::updated(LogOdds before, bool hit) const {
  const int known = before == unknown_log_odds ? 0 : before;
  const int after = hit ? known + steps_.hit : known - steps_.miss;
  return static_cast<LogOdds>(
      std::clamp(after, static_cast<int>(steps_.min), static_cast<int>(steps_.max)));
}

void BandVoxels::apply(const Mask& hits, const Mask& misses, Tile& tile) const {
  const std::size_t words = words_of(layers_);
  for (std::size_t i = 0; i < hits.size(); ++i) {
    std::uint64_t changed = hits[i] | misses[i];
    LogOdds* column = &tile.voxels[i / words * static_cast<std::size_t>(layers_) + i % words * 64];
    while (changed != 0) {
      const auto bit = static_cast<std::size_t>(std::countr_zero(changed));
      changed &= changed - 1;
      const bool hit = (hits[i] >> bit & 1U) != 0;
      column[bit] = updated(column[bit], hit);
    }
  }
}

void BandVoxels::add(std::span<const BandScan> parts, ThreadPool& pool) {
  std::vector<Marks> marks(parts.size(), Marks(layers_));
  pool.for_each_chunk(parts.size(), [&](std::size_t i) { marks[i].mark(parts[i]); });
  if (marks.empty()) return;
  auto& all = marks.front().tiles();
  for (std::size_t i = 1; i < marks.size(); ++i) {
    for (auto& [key, from] : marks[i].tiles()) {
      const auto [to, added] = all.try_emplace(key, std::move(from));
      if (added) continue;
      for (std::size_t word = 0; word < from.hits.size(); ++word) {
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
  const auto probability = [this](LogOdds value) {
    return value == unknown_log_odds ? std::numeric_limits<float>::quiet_NaN()
                                     : static_cast<float>(steps_.probability(value));
  };
  std::vector<float> column(static_cast<std::size_t>(layers_));
  for (const Tile& tile : tiles_) {
    for (int cell = 0; cell < tile_cells * tile_cells; ++cell) {
      const auto begin = static_cast<std::size_t>(cell) * column.size();
      for (std::size_t layer = 0; layer < column.size(); ++layer) {
        column[layer] = probability(tile.voxels[begin + layer]);
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
