// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "kissmap/cloud/voxel.hpp"

namespace kissmap {

/// Voxels along each side of a tile of an occupancy map. Tile t holds voxels 64 t to 64 t + 63.
inline constexpr std::int32_t occupancy_tile_side = 64;

/// Columns of tiles by x and y of their numbers, first included, end left out. The default is the
/// whole plane.
struct TileBox {
  std::int32_t x_first = std::numeric_limits<std::int32_t>::min();
  std::int32_t y_first = std::numeric_limits<std::int32_t>::min();
  std::int32_t x_end = std::numeric_limits<std::int32_t>::max();
  std::int32_t y_end = std::numeric_limits<std::int32_t>::max();

  bool contains(const Voxel& tile) const {
    return tile.x >= x_first && tile.x < x_end && tile.y >= y_first && tile.y < y_end;
  }
  friend bool operator==(const TileBox&, const TileBox&) = default;
};

/// What is in both.
TileBox intersection(const TileBox& a, const TileBox& b);

/// The box cut in two, lower half first, along the side over which `tiles` reach farther (x if
/// alike), so that each half gets about half of them and at least one. `tiles` are inside the box.
/// Nothing if they are all in one column.
std::optional<std::pair<TileBox, TileBox>> halves(const TileBox& box, std::span<const Voxel> tiles);

/// Boxes still to be filled, one after the other: the plane at first. Together they always cover
/// what is not done yet, without overlap.
class TileBoxQueue {
 public:
  /// The next box to fill, from its beginning; nothing when all is done.
  std::optional<TileBox> next();

  /// Gives up a part of the box being filled, to be filled later. Returns what is kept, or nothing
  /// if it cannot become smaller.
  std::optional<TileBox> split(const TileBox& box, std::span<const Voxel> tiles);

  std::size_t waiting() const { return waiting_.size(); }

 private:
  std::vector<TileBox> waiting_ = {TileBox{}};  ///< the next one last
};

}  // namespace kissmap
