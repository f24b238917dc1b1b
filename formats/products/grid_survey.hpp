// SPDX-License-Identifier: MIT
#pragma once

#include <functional>
#include <vector>

#include "kissmap/formats/grid_export.hpp"
#include "kissmap/grid/floor_map.hpp"
#include "kissmap/grid/upright_columns.hpp"
#include "kissmap/mapping/placed_scan.hpp"

namespace kissmap {

/// What is known of a session before rays are cast.
struct GridSurvey {
  Rigid3 level_from_map;
  SensorPath path;  ///< of the scans, level frame
  std::vector<FloorSample> samples;
  UprightColumns upright;
  Eigen::AlignedBox2d seen;           ///< m, level frame: all that rays may have reached
  double half_width = 0.0;            ///< m of the carrier, by its speed
  double sensor_height = 0.0;         ///< m above the floor; 0: no floor seen
  std::vector<std::uint32_t> levels;  ///< of the scans
  std::uint32_t level_count = 1;

  SensorPath path_on(std::uint32_t level) const;
  /// The same in the pieces that it went through without leaving the level.
  std::vector<SensorPath> stretches_on(std::uint32_t level) const;
  FloorMap floor_of(std::uint32_t level) const;
  /// Mean height of the floor under the path [m].
  double height_of(std::uint32_t level) const;
};

/// Reads the log once.
GridSurvey survey_session(const Session& session,
                          const GridExportOptions& options,
                          const ExportProgress& progress);

/// Reads the log and calls with each scan in its place.
void for_each_placed_scan(const Session& session,
                          const GridExportOptions& options,
                          const char* what,
                          const ExportProgress& progress,
                          const std::function<void(const PlacedScan&)>& call);

}  // namespace kissmap
