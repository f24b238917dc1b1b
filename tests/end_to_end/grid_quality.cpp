// SPDX-License-Identifier: MIT
#include "end_to_end/grid_quality.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

namespace kissmap {
namespace {

using simulator::PlanFrame;
using simulator::Simulator;

PlanFrame frame_of(const GridMap& map) {
  return {map.corner, map.resolution, map.width, map.height};
}

MappedScan true_place(const Simulator& simulator, std::size_t scan_idx, const Scan& scan) {
  MappedScan mapped;
  mapped.stamp_ns = scan.stamp_ns;
  const auto span = time_span(scan);
  const double last = span ? static_cast<double>(span->last) : 0.0;
  mapped.pose_stamp_ns = simulator.stamp_ns(scan_idx) + std::llround(1e9 * last);
  mapped.map_from_lidar = simulator.map_from_lidar(mapped.pose_stamp_ns);
  mapped.deskewed = true;
  return mapped;
}

constexpr double range_noise = 0.02;  // m, of the sensors

double share(std::size_t part, std::size_t whole) {
  return whole == 0 ? std::nan("") : static_cast<double>(part) / static_cast<double>(whole);
}

}  // namespace

PlacedScan truly_placed(const Simulator& simulator, std::size_t scan_idx) {
  const Scan scan = simulator.scan(scan_idx);
  const MappedScan mapped = true_place(simulator, scan_idx, scan);
  const MappedScan before = true_place(simulator, scan_idx - 1, scan);
  return place_scan(scan, &before, mapped, 0.0, 100.0);
}

GridJudge::GridJudge(const Simulator& simulator,
                     const simulator::FloorBand& band,
                     const GridMap& map)
    : simulator_(simulator),
      band_(band),
      map_(map),
      truth_(solids_in_band(simulator.caster().world(), frame_of(map), band)),
      returns_(map.cells.size(), 0),
      clear_returns_(map.cells.size(), 0),
      crossed_(map.cells.size(), 0) {
}

void GridJudge::observe(std::size_t scan_idx, bool crossings) {
  if (crossings) {
    mark_crossed(simulator_, scan_idx, false, band_, frame_of(map_), crossed_);
  }
  const simulator::LabelledScan labelled = simulator_.labelled_scan(scan_idx);
  const Scan& scan = labelled.scan;
  for (std::size_t i = 0; i < scan.points.size(); ++i) {
    const Rigid3 map_from_lidar = simulator_.map_from_lidar(
        scan.stamp_ns + std::llround(1e9 * static_cast<double>(scan.time_offsets[i])));
    const Eigen::Vector3d point = map_from_lidar * scan.points[i].cast<double>();
    const std::optional<double> floor =
        floor_height(simulator_.caster().world(), point.x(), point.y(), band_.level);
    if (!floor || point.z() - *floor < band_.z_min || point.z() - *floor > band_.z_max) continue;
    const Eigen::Vector2i cell = map_.cell_of(point.head<2>());
    if (!map_.holds(cell.x(), cell.y())) continue;
    const std::uint32_t of_class = 1U << static_cast<unsigned>(labelled.classes[i]);
    returns_[map_.index(cell.x(), cell.y())] |= of_class;
    const double height = point.z() - *floor;
    if (height < band_.z_min + range_noise || height > band_.z_max - range_noise) continue;
    clear_returns_[map_.index(cell.x(), cell.y())] |= of_class;
  }
}

bool GridJudge::near_solid(int x, int y, int reach) const {
  for (int v = y - reach; v <= y + reach; ++v) {
    for (int u = x - reach; u <= x + reach; ++u) {
      if (map_.holds(u, v) && truth_.touched(u, v)) return true;
    }
  }
  return false;
}

bool GridJudge::near_occupied(int x, int y, int reach) const {
  for (int v = y - reach; v <= y + reach; ++v) {
    for (int u = x - reach; u <= x + reach; ++u) {
      if (map_.holds(u, v) && map_.at(u, v).state == CellState::occupied) return true;
    }
  }
  return false;
}

bool GridJudge::is_seen_wall(int x, int y) const {
  const std::size_t i = map_.index(x, y);
  const auto wall = static_cast<unsigned>(simulator::ObjectClass::wall);
  return ((truth_.classes[i] & clear_returns_[i]) >> wall & 1U) != 0;
}

int GridJudge::widest_wall_gap(int reach) const {
  GridMap missed = map_;
  for (int y = 0; y < map_.height; ++y) {
    for (int x = 0; x < map_.width; ++x) {
      const bool hidden = is_seen_wall(x, y) && !near_occupied(x, y, reach);
      missed.at(x, y).state = hidden ? CellState::occupied : CellState::free;
    }
  }
  int widest = 0;
  for (int y = 0; y < map_.height; ++y) {
    for (int x = 0; x < map_.width; ++x) {
      int along_x = 0;
      int along_y = 0;
      while (x + along_x < map_.width && missed.at(x + along_x, y).state == CellState::occupied) {
        ++along_x;
      }
      while (y + along_y < map_.height && missed.at(x, y + along_y).state == CellState::occupied) {
        ++along_y;
      }
      widest = std::max({widest, along_x, along_y});
    }
  }
  return widest;
}

GridQuality GridJudge::judge(int reach) const {
  std::size_t occupied = 0;
  std::size_t right = 0;
  std::size_t seen = 0;
  std::size_t found = 0;
  std::size_t empty = 0;
  std::size_t free = 0;
  std::array<std::size_t, simulator::object_classes> seen_of{};
  std::array<std::size_t, simulator::object_classes> found_of{};
  for (int y = 0; y < map_.height; ++y) {
    for (int x = 0; x < map_.width; ++x) {
      const std::size_t i = map_.index(x, y);
      if (map_.cells[i].state == CellState::occupied) {
        ++occupied;
        right += near_solid(x, y, reach) ? 1 : 0;
      }
      if (truth_.classes[i] == 0 && crossed_[i] != 0) {
        ++empty;
        free += map_.cells[i].state == CellState::free ? 1 : 0;
      }
      const std::uint32_t classes = truth_.classes[i] & returns_[i];
      if (classes == 0) continue;
      const bool is_found = near_occupied(x, y, reach);
      ++seen;
      found += is_found ? 1 : 0;
      for (std::size_t c = 0; c < seen_of.size(); ++c) {
        if ((classes >> c & 1U) == 0) continue;
        ++seen_of[c];
        found_of[c] += is_found ? 1 : 0;
      }
    }
  }
  GridQuality quality;
  quality.precision = share(right, occupied);
  quality.recall = share(found, seen);
  quality.free_recall = share(free, empty);
  for (std::size_t c = 0; c < seen_of.size(); ++c) {
    quality.class_recall[c] = share(found_of[c], seen_of[c]);
  }
  quality.widest_wall_gap = widest_wall_gap(reach);
  return quality;
}

}  // namespace kissmap
