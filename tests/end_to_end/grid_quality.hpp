// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "kissmap/grid/grid_map.hpp"
#include "kissmap/mapping/placed_scan.hpp"
#include "simulator/plan_truth.hpp"

namespace kissmap {

/// Shares of cells, NaN where there are none to judge.
struct GridQuality {
  double precision = 0.0;  ///< of the occupied cells, those with a solid at most `reach` cells away
  double recall = 0.0;     ///< of the plan's cells in which a return fell, those found
  std::array<double, simulator::object_classes> class_recall{};
  double free_recall = 0.0;  ///< of the empty cells that a ray crossed in the band, those free
  /// Cells along x or y, of walls in which returns fell, 2 cm within the band, and none was found.
  int widest_wall_gap = 0;

  double recall_of(simulator::ObjectClass object_class) const {
    return class_recall[static_cast<std::size_t>(object_class)];
  }
};

/// Judges a map in the world's frame against the exact plan of a simulated world.
class GridJudge {
 public:
  /// The map must be in the frame of `simulator`'s world.
  GridJudge(const simulator::Simulator& simulator,
            const simulator::FloorBand& band,
            const GridMap& map);

  /// Tells of a scan what it could know. Crossings are exact and slow: not needed of every scan.
  void observe(std::size_t scan_idx, bool crossings);

  /// `reach` [cells] in which a found cell may lie off the true one.
  GridQuality judge(int reach) const;

 private:
  bool near_solid(int x, int y, int reach) const;
  bool near_occupied(int x, int y, int reach) const;
  bool is_seen_wall(int x, int y) const;
  int widest_wall_gap(int reach) const;

  const simulator::Simulator& simulator_;
  simulator::FloorBand band_;
  const GridMap& map_;
  simulator::PlanTruth truth_;
  std::vector<std::uint32_t> returns_;  ///< bits of the classes of which a return fell into a cell
  /// The same for returns that are not within the sensor's noise of the band's ends.
  std::vector<std::uint32_t> clear_returns_;
  std::vector<std::uint8_t> crossed_;
};

/// A scan placed by the truth; `scan_idx` > 0 so that there is one before it.
PlacedScan truly_placed(const simulator::Simulator& simulator, std::size_t scan_idx);

}  // namespace kissmap
