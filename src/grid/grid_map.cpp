// SPDX-License-Identifier: MIT
#include "kissmap/grid/grid_map.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <utility>

#include "kissmap/error.hpp"
#include "options.hpp"

namespace kissmap {
namespace {

constexpr std::array<std::array<int, 2>, 8> neighbors = {
    {{-1, 0}, {1, 0}, {0, -1}, {0, 1}, {-1, -1}, {1, -1}, {-1, 1}, {1, 1}}};

/// The occupied cells connected to one of them; marks them in `visited`.
std::vector<Eigen::Vector2i> group_of(const GridMap& map,
                                      Eigen::Vector2i first,
                                      std::vector<bool>& visited) {
  std::vector<Eigen::Vector2i> group = {first};
  visited[map.index(first.x(), first.y())] = true;
  for (std::size_t i = 0; i < group.size(); ++i) {
    for (const auto& [dx, dy] : neighbors) {
      const int x = group[i].x() + dx;
      const int y = group[i].y() + dy;
      if (!map.holds(x, y) || map.at(x, y).state != CellState::occupied) continue;
      if (visited[map.index(x, y)]) continue;
      visited[map.index(x, y)] = true;
      group.emplace_back(x, y);
    }
  }
  return group;
}

double most_believed(const GridMap& map, const std::vector<Eigen::Vector2i>& group) {
  double most = 0.0;
  for (const Eigen::Vector2i& cell : group) {
    most = std::max(most, static_cast<double>(map.at(cell.x(), cell.y()).probability));
  }
  return most;
}

/// Unknown where at least half of the cells around the group are, else free with their mean.
GridCell surroundings(const GridMap& map, const std::vector<Eigen::Vector2i>& group) {
  int free = 0;
  int unknown = 0;
  float sum = 0.0F;
  for (const Eigen::Vector2i& cell : group) {
    for (const auto& [dx, dy] : neighbors) {
      if (!map.holds(cell.x() + dx, cell.y() + dy)) continue;
      const GridCell& beside = map.at(cell.x() + dx, cell.y() + dy);
      unknown += beside.state == CellState::unknown ? 1 : 0;
      if (beside.state != CellState::free) continue;
      ++free;
      sum += beside.probability;
    }
  }
  if (free <= unknown) return {};
  return {CellState::free, sum / static_cast<float>(free)};
}

}  // namespace

void require_valid(const ColumnRule& rule) {
  require_between("threshold", rule.threshold, 0.01, 0.99);
  require_between("min_free", rule.min_free, 0.0, 1.0);
  require_between("min_seen", rule.min_seen, 0.0, 1.0);
}

GridCell judge_column(const ColumnCounts& column, int layers, const ColumnRule& rule) {
  if (column.seen == 0) return {};
  if (static_cast<double>(column.highest) > rule.threshold) {
    return {CellState::occupied, column.highest};
  }
  const double share = static_cast<double>(column.seen) / layers;
  const bool enough =
      share >= rule.min_seen && column.free > 0 && column.free >= rule.min_free * column.seen;
  return {enough ? CellState::free : CellState::unknown, column.highest};
}

std::size_t remove_small_groups(int least, GridMap& map, double most) {
  std::vector<bool> visited(map.cells.size(), false);
  // Changed at the end: each group is judged by the map as it was.
  std::vector<std::pair<std::size_t, GridCell>> changes;
  for (int y = 0; y < map.height; ++y) {
    for (int x = 0; x < map.width; ++x) {
      if (map.at(x, y).state != CellState::occupied || visited[map.index(x, y)]) continue;
      const std::vector<Eigen::Vector2i> group = group_of(map, {x, y}, visited);
      if (group.size() >= static_cast<std::size_t>(std::max(0, least))) continue;
      if (most_believed(map, group) > most) continue;
      const GridCell cell = surroundings(map, group);
      for (const Eigen::Vector2i& place : group) {
        changes.emplace_back(map.index(place.x(), place.y()), cell);
      }
    }
  }
  for (const auto& [idx, cell] : changes) map.cells[idx] = cell;
  return changes.size();
}

std::size_t keep_connected_free(std::span<const Eigen::Vector2d> path, GridMap& map) {
  std::vector<bool> reached(map.cells.size(), false);
  std::vector<Eigen::Vector2i> open;
  const auto reach = [&](int x, int y) {
    if (!map.holds(x, y) || map.at(x, y).state != CellState::free) return;
    if (reached[map.index(x, y)]) return;
    reached[map.index(x, y)] = true;
    open.emplace_back(x, y);
  };
  for (const Eigen::Vector2d& place : path) {
    const Eigen::Vector2i cell = map.cell_of(place);
    reach(cell.x(), cell.y());
  }
  while (!open.empty()) {
    const Eigen::Vector2i cell = open.back();
    open.pop_back();
    for (std::size_t i = 0; i < 4; ++i) {
      reach(cell.x() + neighbors[i][0], cell.y() + neighbors[i][1]);
    }
  }
  std::size_t changed = 0;
  for (std::size_t i = 0; i < map.cells.size(); ++i) {
    if (map.cells[i].state != CellState::free || reached[i]) continue;
    map.cells[i] = {};
    ++changed;
  }
  return changed;
}

GridMap joined(GridMap a, GridMap b) {
  if (a.cells.empty()) return b;
  if (b.cells.empty()) return a;
  const auto first_cell = [](const GridMap& map) -> Eigen::Vector2i {
    return (map.corner / map.resolution).array().round().cast<int>();
  };
  const auto end_cell = [&](const GridMap& map) -> Eigen::Vector2i {
    return first_cell(map) + Eigen::Vector2i(map.width, map.height);
  };
  const Eigen::Vector2i first = first_cell(a).cwiseMin(first_cell(b));
  const Eigen::Vector2i size = end_cell(a).cwiseMax(end_cell(b)) - first;
  GridMap both;
  both.resolution = a.resolution;
  both.corner = first.cast<double>() * a.resolution;
  both.width = size.x();
  both.height = size.y();
  both.cells.resize(static_cast<std::size_t>(size.x()) * static_cast<std::size_t>(size.y()));
  for (const GridMap* map : {&a, &b}) {
    const Eigen::Vector2i shift = first_cell(*map) - first;
    for (int y = 0; y < map->height; ++y) {
      for (int x = 0; x < map->width; ++x) {
        const GridCell& cell = map->at(x, y);
        if (cell.state == CellState::unknown && cell.probability == 0.5F) continue;
        both.at(shift.x() + x, shift.y() + y) = cell;
      }
    }
  }
  return both;
}

GridMap cropped(const GridMap& map, const Eigen::AlignedBox2d& area) {
  // A border that lies on one between cells, but for rounding, is that one.
  constexpr double slack = 1e-6;
  const Eigen::Vector2d low = (area.min() - map.corner) / map.resolution;
  const Eigen::Vector2d high = (area.max() - map.corner) / map.resolution;
  const Eigen::Vector2i first = (low.array() + slack).floor().cast<int>();
  const Eigen::Vector2i last = (high.array() - slack).ceil().cast<int>();
  GridMap part;
  part.resolution = map.resolution;
  part.corner = map.corner + first.cast<double>() * map.resolution;
  part.width = std::max(0, last.x() - first.x());
  part.height = std::max(0, last.y() - first.y());
  part.cells.resize(static_cast<std::size_t>(part.width) * static_cast<std::size_t>(part.height));
  for (int y = 0; y < part.height; ++y) {
    for (int x = 0; x < part.width; ++x) {
      if (map.holds(x + first.x(), y + first.y())) {
        part.at(x, y) = map.at(x + first.x(), y + first.y());
      }
    }
  }
  return part;
}

GridMap trimmed(const GridMap& map, int margin) {
  Eigen::AlignedBox2d area;
  for (int y = 0; y < map.height; ++y) {
    for (int x = 0; x < map.width; ++x) {
      if (map.at(x, y).state == CellState::unknown) continue;
      area.extend(map.corner + Eigen::Vector2d(x - margin, y - margin) * map.resolution);
      area.extend(map.corner + Eigen::Vector2d(x + 1 + margin, y + 1 + margin) * map.resolution);
    }
  }
  if (area.isEmpty()) area = Eigen::AlignedBox2d(map.corner, map.corner);
  return cropped(map, area);
}

}  // namespace kissmap
