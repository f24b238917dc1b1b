// SPDX-License-Identifier: MIT
#include "kissmap/formats/grid_export.hpp"

#include <cstdio>
#include <deque>
#include <string>
#include <utility>

#include "formats/files/output_file.hpp"
#include "formats/products/cast_in_parts.hpp"
#include "formats/products/grid_survey.hpp"
#include "formats/products/resolution.hpp"
#include "kissmap/error.hpp"
#include "kissmap/grid/band_mapper.hpp"

namespace kissmap {
namespace {

namespace fs = std::filesystem;

constexpr int margin = 2;  // cells around what is known

fs::path with_suffix(fs::path stem, const std::string& suffix) {
  stem += suffix;
  return stem;
}

std::string number(double value) {
  char text[32];
  std::snprintf(text, sizeof(text), "%.9g", value);
  return text;
}

GridBand band_of(const GridExportOptions& options, double resolution) {
  return {options.z_min, options.z_max, resolution, options.max_range};
}

double resolution_of(const GridExportOptions& options, const Session& session) {
  if (options.resolution != 0.0) return options.resolution;
  return fitting_resolution(session, options.min_range, options.max_range, options.moved_log).cell;
}

void require_options(const GridExportOptions& options) {
  require_valid(options.rule);
  require_valid(band_of(options, options.resolution == 0.0 ? 0.05 : options.resolution));
  if (!options.crop) return;
  const Eigen::Vector2d size = options.crop->max() - options.crop->min();
  if (!(size.minCoeff() > 0.0)) {
    throw usage_error("crop: give x and y of the lower corner, then of the upper one [m]");
  }
}

/// All that write_level() writes.
std::vector<fs::path> files_of(const fs::path& stem, GridMode mode) {
  std::vector<fs::path> files = grid_file_paths(stem, mode);
  files.push_back(with_suffix(stem, "_look.png"));
  return files;
}

void require_new(const fs::path& stem, const GridExportOptions& options) {
  std::error_code code;
  for (const fs::path& file : files_of(stem, options.mode)) {
    if (!options.overwrite && fs::exists(file, code)) {
      throw usage_error(file.string() + ": exists; add --overwrite to replace it");
    }
  }
}

std::vector<fs::path> stems_of(const fs::path& stem, std::uint32_t levels) {
  if (levels == 1) return {stem};
  std::vector<fs::path> stems;
  for (std::uint32_t level = 0; level < levels; ++level) {
    stems.push_back(with_suffix(stem, "_level" + std::to_string(level)));
  }
  return stems;
}

std::vector<Eigen::Vector2d> plan_of(const SensorPath& path) {
  std::vector<Eigen::Vector2d> plan;
  for (const Eigen::Vector3d& place : path) plan.emplace_back(place.head<2>());
  return plan;
}

/// Of the YAML: what heights it looks at, and where it lies beside the session's trajectory.
std::vector<std::string> comments(const GridExportOptions& options, const Rigid3& level_from_map) {
  const Eigen::Vector3d& t = level_from_map.translation;
  const Eigen::Quaterniond& q = level_from_map.rotation;
  std::string pose;
  for (const double value : {t.x(), t.y(), t.z(), q.x(), q.y(), q.z(), q.w()}) {
    pose += (pose.empty() ? "" : " ") + number(value);
  }
  return {number(options.z_min) + " m to " + number(options.z_max) + " m above " +
              (options.floor_reference ? "the floor" : "the level of the first local map's ground"),
          "levelled; from the session's map frame by x y z qx qy qz qw",
          pose};
}

/// The maps of all storeys.
std::vector<GridMap> cast_rays(const Session& session,
                               const GridExportOptions& options,
                               const GridSurvey& survey,
                               ThreadPool& pool,
                               const ExportProgress& progress) {
  const GridBand band = band_of(options, resolution_of(options, session));
  std::deque<BandMapper> mappers;
  std::vector<OccupancyMap*> voxels;
  for (std::uint32_t level = 0; level < survey.level_count; ++level) {
    mappers.emplace_back(survey.floor_of(level), band, options.belief);
    voxels.push_back(&mappers.back().voxels());
  }
  std::vector<GridMap> maps(mappers.size());
  cast_in_parts(
      session,
      {options.min_range, options.max_range, options.moved_log, options.max_memory},
      voxels,
      progress,
      [&](const PlacedScan& scan) {
        mappers[survey.levels[scan.scan_idx]].add(scan, survey.level_from_map, pool);
      },
      [&] {
        for (std::size_t level = 0; level < maps.size(); ++level) {
          maps[level] = joined(maps[level], mappers[level].grid(options.rule));
        }
      });
  return maps;
}

GridMap finished(GridMap map,
                 const GridExportOptions& options,
                 const std::vector<Eigen::Vector2d>& plan) {
  if (options.min_group > 0) remove_small_groups(options.min_group, map);
  if (options.connected) keep_connected_free(plan, map);
  return options.crop ? cropped(map, *options.crop) : trimmed(map, margin);
}

void write_contents(const fs::path& file,
                    const GridSurvey& survey,
                    const std::vector<ExportedGrid>& levels) {
  std::string yaml = "# maps of the storeys, from the lowest up; mean height of the floor [m]\n";
  yaml += "levels:\n";
  for (std::uint32_t level = 0; level < levels.size(); ++level) {
    char height[32];
    std::snprintf(height, sizeof(height), "%.2f", survey.height_of(level));
    yaml += "  - {level: " + std::to_string(level) + ", height: " + height +
            ", map: " + yaml_quoted(levels[level].yaml.filename().string()) + "}\n";
  }
  write_whole_file(file, yaml);
}

}  // namespace

GridExportSummary export_grid(const Session& session,
                              const fs::path& stem,
                              const GridExportOptions& options,
                              ThreadPool& pool,
                              const ExportProgress& progress) {
  require_options(options);
  require_new(stem, options);
  const GridSurvey survey = survey_session(session, options, progress);
  const std::vector<fs::path> stems = stems_of(stem, survey.level_count);
  for (const fs::path& each : stems) require_new(each, options);
  std::vector<GridMap> maps = cast_rays(session, options, survey, pool, progress);
  GridExportSummary summary;
  summary.floor_seen = !options.floor_reference || survey.sensor_height > 0.0;
  for (std::uint32_t level = 0; level < survey.level_count; ++level) {
    const std::vector<Eigen::Vector2d> plan = plan_of(survey.path_on(level));
    ExportedGrid grid;
    grid.map = finished(std::move(maps[level]), options, plan);
    grid.scans = plan.size();
    grid.yaml = grid_file_paths(stems[level], options.mode).back();
    write_grid(grid.map, options.mode, stems[level], comments(options, survey.level_from_map));
    write_png(draw_grid(grid.map, plan), with_suffix(stems[level], "_look.png"));
    summary.levels.push_back(std::move(grid));
  }
  if (summary.levels.size() > 1) {
    write_contents(with_suffix(stem, "_levels.yaml"), survey, summary.levels);
  }
  return summary;
}

}  // namespace kissmap
