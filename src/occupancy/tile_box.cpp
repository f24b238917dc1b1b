// SPDX-License-Identifier: MIT
#include "kissmap/occupancy/tile_box.hpp"

#include <algorithm>

namespace kissmap {
namespace {

/// Where to cut numbers that are not all the same, so that both halves get some.
std::int32_t cut_of(std::vector<std::int32_t> numbers) {
  std::ranges::sort(numbers);
  const std::int32_t median = numbers[numbers.size() / 2];
  if (median > numbers.front()) return median;
  return *std::ranges::upper_bound(numbers, median);
}

std::vector<std::int32_t> numbers_of(std::span<const Voxel> tiles, std::int32_t Voxel::*axis) {
  std::vector<std::int32_t> numbers;
  numbers.reserve(tiles.size());
  for (const Voxel& tile : tiles) numbers.push_back(tile.*axis);
  return numbers;
}

std::int64_t extent_of(const std::vector<std::int32_t>& numbers) {
  const auto [low, high] = std::ranges::minmax(numbers);
  return std::int64_t{high} - low;
}

}  // namespace

TileBox intersection(const TileBox& a, const TileBox& b) {
  return {std::max(a.x_first, b.x_first),
          std::max(a.y_first, b.y_first),
          std::min(a.x_end, b.x_end),
          std::min(a.y_end, b.y_end)};
}

std::optional<std::pair<TileBox, TileBox>> halves(const TileBox& box,
                                                  std::span<const Voxel> tiles) {
  if (tiles.empty()) return std::nullopt;
  const std::vector<std::int32_t> x = numbers_of(tiles, &Voxel::x);
  const std::vector<std::int32_t> y = numbers_of(tiles, &Voxel::y);
  const bool along_x = extent_of(x) >= extent_of(y);
  if (extent_of(along_x ? x : y) == 0) return std::nullopt;
  std::pair<TileBox, TileBox> parts{box, box};
  if (along_x) {
    parts.first.x_end = parts.second.x_first = cut_of(x);
  } else {
    parts.first.y_end = parts.second.y_first = cut_of(y);
  }
  return parts;
}

std::optional<TileBox> TileBoxQueue::next() {
  if (waiting_.empty()) return std::nullopt;
  const TileBox box = waiting_.back();
  waiting_.pop_back();
  return box;
}

std::optional<TileBox> TileBoxQueue::split(const TileBox& box, std::span<const Voxel> tiles) {
  const auto parts = halves(box, tiles);
  if (!parts) return std::nullopt;
  waiting_.push_back(parts->second);
  return parts->first;
}

}  // namespace kissmap
