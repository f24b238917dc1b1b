// SPDX-License-Identifier: MIT
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <vector>

#include "kissmap/formats/export_progress.hpp"
#include "kissmap/formats/grid_files.hpp"
#include "kissmap/formats/session.hpp"
#include "kissmap/grid/band_mapper.hpp"
#include "kissmap/grid/grid_map.hpp"
#include "kissmap/parallel/thread_pool.hpp"

namespace kissmap {

/// What of a session becomes a 2D map, and how.
struct GridExportOptions {
  double min_range = 0.0;       ///< m; nearer returns are left out
  double max_range = 100.0;     ///< m; farther ones, too
  double z_min = 0.1;           ///< m
  double z_max = 1.8;           ///< m
  double resolution = 0.0;      ///< m; 0: 0.05, 0.1 or 0.2 by how near things are
  bool floor_reference = true;  ///< heights from the floor, else from the level of the start
  GridMode mode = GridMode::trinary;
  BandBelief belief;
  ColumnRule rule{navigation_threshold, 0.5, 0.0};
  int min_group = 0;       ///< cells, see remove_small_groups
  int min_weak_group = 0;  ///< the same of what rests on single returns
  /// m that the sensor's carrier reaches to all sides, see BandMapper::clear_way; none: by its
  /// speed, 0.25 for what walks or rolls, 0.8 for what drives
  std::optional<double> half_width;
  bool connected = false;                    ///< see keep_connected_free
  bool align_axes = false;                   ///< turns the walls along x and y
  std::optional<Eigen::AlignedBox2d> crop;   ///< m
  std::uint64_t max_memory = 4'000'000'000;  ///< bytes of the voxels rays are cast into, of cells
  bool overwrite = false;
  std::filesystem::path moved_log;  ///< where the log is now, if it moved
};

/// The map of one storey, as written.
struct ExportedGrid {
  std::uint32_t level = 0;  ///< from the lowest up
  std::filesystem::path yaml;
  GridMap map;
  std::uint64_t scans = 0;  ///< whose rays were cast
};

struct GridExportSummary {
  std::vector<ExportedGrid> levels;  ///< from the lowest up
  std::uint32_t levels_outside = 0;  ///< of which nothing was seen in the crop: not written
  bool floor_seen = true;            ///< false: heights are those above the level of the start
  std::uint64_t no_returns = 0;      ///< rays without a return; 0 unless they are believed
};

/// Casts the rays of a session's scans and writes a map of each storey the path goes through:
/// STEM.pgm (or .png), STEM.yaml and STEM_look.png; with several storeys STEM_level0... and
/// STEM_levels.yaml, which lists them. Frame: that of the session, levelled by level_from_map();
/// the YAML says by what. The same bytes on every run, for any number of threads and for any
/// max_memory: voxels that do not fit are cast in parts. Reads the log twice, and once more for
/// each further part. Cells, 28 bytes each while they are made, have to fit into max_memory, too:
/// cells that are not asked for become larger until they do. All files are written aside before
/// the first gets its name. Throws Error(usage) for options out of range, for a crop in which
/// nothing was seen and for cells that do not fit; Error(input) as SessionReplay does;
/// Error(output) naming the file, also for one that is there without `overwrite`.
GridExportSummary export_grid(const Session& session,
                              const std::filesystem::path& stem,
                              const GridExportOptions& options,
                              ThreadPool& pool,
                              const ExportProgress& progress);

}  // namespace kissmap
