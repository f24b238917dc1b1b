// SPDX-License-Identifier: MIT
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

namespace kissmap {

/// m; no limit.
inline Eigen::AlignedBox2d everywhere() {
  return {Eigen::Vector2d::Constant(-1e9), Eigen::Vector2d::Constant(1e9)};
}

enum class CellState : std::uint8_t { unknown, free, occupied };

/// A cell of a 2D map: its state, and the probability that something stands in it (0.5 where
/// nothing is known).
struct GridCell {
  CellState state = CellState::unknown;
  float probability = 0.5F;
  friend bool operator==(const GridCell&, const GridCell&) = default;
};

/// A 2D occupancy map of a z band. Cell (x, y) covers [corner + x r, corner + (x+1) r) and so on;
/// rows run from the lowest y to the highest.
struct GridMap {
  double resolution = 0.05;                          ///< m
  Eigen::Vector2d corner = Eigen::Vector2d::Zero();  ///< m, outer corner of cell (0, 0)
  int width = 0;
  int height = 0;
  std::vector<GridCell> cells;

  bool holds(int x, int y) const { return x >= 0 && y >= 0 && x < width && y < height; }
  GridCell& at(int x, int y) { return cells[index(x, y)]; }
  const GridCell& at(int x, int y) const { return cells[index(x, y)]; }
  std::size_t index(int x, int y) const {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(width) +
           static_cast<std::size_t>(x);
  }
  /// The cell of a place, inside the map or not.
  Eigen::Vector2i cell_of(const Eigen::Vector2d& place) const {
    return ((place - corner) / resolution).array().floor().cast<int>();
  }
};

/// For maps whose doors must be open: one glance at somebody walking by makes no obstacle (0.7).
inline constexpr double navigation_threshold = 0.65;
/// For maps of thin layers, in which a chair's leg may be seen but once.
inline constexpr double localization_threshold = 0.5;

/// What a column of the band's voxels makes of its cell.
struct ColumnRule {
  double threshold = localization_threshold;  ///< a voxel is occupied above this probability, free
                                              ///< below both this and 0.5
  double min_free = 0.5;  ///< share of the seen voxels that must be free for a free cell
  double min_seen = 0.0;  ///< share of the band that must be seen for a free cell
};
/// Throws Error(usage) naming the field, its value and its range.
void require_valid(const ColumnRule& rule);

/// The voxels of a column that were seen.
struct ColumnCounts {
  std::int32_t seen = 0;
  std::int32_t free = 0;  ///< below the threshold of the rule and 0.5
  float highest = 0.0F;   ///< probability
};

/// Occupied if any voxel is; free if enough of the band's `layers` was seen, at least one voxel,
/// and enough of that is free; unknown otherwise.
GridCell judge_column(const ColumnCounts& column, int layers, const ColumnRule& rule);

/// Takes groups of fewer than `least` occupied cells (8 neighbours), of which none is believed more
/// than `most` [probability], for what most of the cells around them are. Returns how many cells
/// were changed.
std::size_t remove_small_groups(int least, GridMap& map, double most = 1.0);

/// Free cells that cannot be reached from `path` [m] over free cells (4 neighbours) become unknown.
/// Returns how many cells were changed.
std::size_t keep_connected_free(std::span<const Eigen::Vector2d> path, GridMap& map);

/// A map of all that either of two knows, for maps of one resolution that are aligned to its
/// multiples; where both do, what `b` says.
GridMap joined(GridMap a, GridMap b);

/// The part of a map inside a rectangle [m], widened to whole cells; unknown where the map ends.
/// The rectangle must end within 2^31 cells of the frame's origin.
GridMap cropped(const GridMap& map, const Eigen::AlignedBox2d& area);

/// The smallest part that holds all known cells, with `margin` unknown ones around.
GridMap trimmed(const GridMap& map, int margin);

}  // namespace kissmap
