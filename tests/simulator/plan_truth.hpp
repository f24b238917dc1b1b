// SPDX-License-Identifier: MIT
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "simulator/simulator.hpp"
#include "simulator/world.hpp"

namespace kissmap::simulator {

/// Cells seen from above: cell (column, row) covers lower_left + resolution * [column, column + 1)
/// x [row, row + 1). Rows are stored one after the other, the one with the lowest y first.
struct PlanFrame {
  Eigen::Vector2d lower_left = Eigen::Vector2d::Zero();  ///< m
  double resolution = 0.05;                              ///< m
  int columns = 0;
  int rows = 0;

  std::size_t size() const {
    return static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows);
  }
  std::size_t index(int column, int row) const {
    return static_cast<std::size_t>(row) * static_cast<std::size_t>(columns) +
           static_cast<std::size_t>(column);
  }
  Eigen::Vector2d corner(int column, int row) const {
    return lower_left + resolution * Eigen::Vector2d(column, row);
  }
};

/// The layer between two heights above the floor of a level. It follows the floor, slopes included.
struct FloorBand {
  double z_min = 0.1;  ///< m above the floor
  double z_max = 1.0;  ///< m above the floor
  int level = 0;
};

/// Which classes of static solids touch the band over each cell. Exact: solids, floors and cells
/// are intersected as they are, nothing is sampled. What overlaps by less than a nanometre along
/// any axis only borders and does not touch. Steps between pieces of the floor are no solids.
struct PlanTruth {
  PlanFrame frame;
  std::vector<std::uint32_t> classes;  ///< a bit for each ObjectClass; cells as in PlanFrame

  bool touched(int column, int row, ObjectClass by) const {
    return (classes[frame.index(column, row)] >> static_cast<unsigned>(by) & 1U) != 0;
  }
  bool touched(int column, int row) const { return classes[frame.index(column, row)] != 0; }
};

/// Throws Error(usage) where the band or the frame is empty, where the level has no floor, or where
/// a static cylinder does not stand upright.
PlanTruth solids_in_band(const World& world, const PlanFrame& frame, const FloorBand& band);

/// Marks the cells over which a straight ray runs through the band, if only by a nanometre. Pieces
/// of the floor bend the band, not the ray. `crossed` has frame.size() bytes. Exact as above.
void mark_crossed(const World& world,
                  const FloorBand& band,
                  const Eigen::Vector3d& from,
                  const Eigen::Vector3d& to,
                  const PlanFrame& frame,
                  std::vector<std::uint8_t>& crossed);

/// The same for all rays of a scan that left a return, up to the true surface, and, if asked, for
/// those without a return up to the sensor's range. What the sensor could know to be free.
void mark_crossed(const Simulator& simulator,
                  std::size_t scan_idx,
                  bool no_returns,
                  const FloorBand& band,
                  const PlanFrame& frame,
                  std::vector<std::uint8_t>& crossed);

}  // namespace kissmap::simulator
