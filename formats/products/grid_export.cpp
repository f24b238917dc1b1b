// SPDX-License-Identifier: MIT
#include "kissmap/formats/grid_export.hpp"

#include <algorithm>
#include <cstdio>
#include <deque>
#include <string>
#include <utility>

#include "formats/files/output_file.hpp"
#include "formats/grids/grid_bytes.hpp"
#include "formats/pictures/png.hpp"
#include "formats/products/cast_in_parts.hpp"
#include "formats/products/grid_size.hpp"
#include "formats/products/grid_survey.hpp"
#include "formats/products/grid_target.hpp"
#include "formats/products/resolution.hpp"
#include "kissmap/error.hpp"
#include "kissmap/grid/band_mapper.hpp"

namespace kissmap {
namespace {

namespace fs = std::filesystem;

constexpr int margin = 2;         // cells around what is known
constexpr double farthest = 1e7;  // m, of the corners of a crop

// Believed no more than this, in doubt rounding, is what a single return makes.
double one_return(const GridExportOptions& options) {
  return options.belief.log_odds.hit_probability + 0.01;
}

std::string number(double value) {
  char text[32];
  std::snprintf(text, sizeof(text), "%.9g", value);
  return text;
}

GridBand band_of(const GridExportOptions& options, double resolution) {
  return {options.z_min, options.z_max, resolution, options.max_range};
}

double resolution_of(const GridExportOptions& options,
                     const Session& session,
                     const GridSurvey& survey) {
  double fitting = 0.0;
  if (options.resolution == 0.0) {
    fitting =
        fitting_resolution(session, options.min_range, options.max_range, options.moved_log).cell;
  }
  return resolution_in_memory(fitting, survey.seen, survey.level_count, options);
}

void require_options(const GridExportOptions& options) {
  require_valid(options.rule);
  const double reach = options.belief.no_return_range;
  if (!(reach >= 0.0 && reach <= 1000.0)) {
    throw usage_error("--no-return-range = " + number(reach) + " is outside 0..1000");
  }
  require_valid(band_of(options, options.resolution == 0.0 ? 0.05 : options.resolution));
  if (!options.crop) return;
  for (const Eigen::Vector2d& corner : {options.crop->min(), options.crop->max()}) {
    if (corner.array().abs().maxCoeff() <= farthest && !corner.hasNaN()) continue;
    throw usage_error("crop: corners are numbers of metres within 10,000 km of the origin");
  }
  const Eigen::Vector2d size = options.crop->max() - options.crop->min();
  if (!(size.minCoeff() > 0.0)) {
    throw usage_error("crop: give x and y of the lower corner, then of the upper one [m]");
  }
}

std::vector<PlanPath> plans_of(const std::vector<SensorPath>& stretches) {
  std::vector<PlanPath> plans;
  for (const SensorPath& stretch : stretches) {
    PlanPath& plan = plans.emplace_back();
    for (const Eigen::Vector3d& place : stretch) plan.emplace_back(place.head<2>());
  }
  return plans;
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

struct StoreyMaps {
  std::vector<GridMap> maps;
  std::uint64_t no_returns = 0;
};

/// What of the plane becomes cells: beside a crop, groups are whole as far as they count.
Eigen::AlignedBox2d area_of(const GridSurvey& survey,
                            const GridExportOptions& options,
                            double resolution) {
  if (!options.crop || options.connected) return everywhere();
  const double beside = resolution * (1.0 + std::max(options.min_group, options.min_weak_group));
  const Eigen::AlignedBox2d area = worked_area(survey.seen, options);
  return {Eigen::Vector2d(area.min().array() - beside),
          Eigen::Vector2d(area.max().array() + beside)};
}

/// The maps of all storeys.
StoreyMaps cast_rays(const Session& session,
                     const GridExportOptions& options,
                     const GridSurvey& survey,
                     ThreadPool& pool,
                     const ExportProgress& progress) {
  const GridBand band = band_of(options, resolution_of(options, session, survey));
  const Eigen::AlignedBox2d area = area_of(survey, options, band.resolution);
  std::deque<BandMapper> mappers;
  std::vector<OccupancyMap*> voxels;
  for (std::uint32_t level = 0; level < survey.level_count; ++level) {
    mappers.emplace_back(survey.floor_of(level), band, options.belief, &survey.upright);
    for (const SensorPath& stretch : survey.stretches_on(level)) {
      mappers.back().clear_way(stretch, options.half_width.value_or(survey.half_width));
    }
    voxels.push_back(&mappers.back().voxels());
  }
  std::vector<GridMap> maps(mappers.size());
  const CastSummary cast = cast_in_parts(
      session,
      {options.min_range,
       options.max_range,
       options.moved_log,
       options.max_memory,
       options.belief.no_return_range > 0.0},
      voxels,
      progress,
      [&](const PlacedScan& scan) {
        mappers[survey.levels[scan.scan_idx]].add(scan, survey.level_from_map, pool);
      },
      [&] {
        for (std::size_t level = 0; level < maps.size(); ++level) {
          maps[level] = joined(std::move(maps[level]), mappers[level].grid(options.rule, area));
        }
      });
  return {std::move(maps), cast.no_returns};
}

GridMap finished(GridMap map,
                 const GridExportOptions& options,
                 const std::vector<PlanPath>& stretches) {
  if (options.min_group > 0) remove_small_groups(options.min_group, map);
  if (options.min_weak_group > 0) {
    remove_small_groups(options.min_weak_group, map, one_return(options));
  }
  if (options.connected) {
    PlanPath way;
    for (const PlanPath& stretch : stretches) way.insert(way.end(), stretch.begin(), stretch.end());
    keep_connected_free(way, map);
  }
  return options.crop ? cropped(map, *options.crop) : trimmed(map, margin);
}

bool is_known(const GridCell& cell) {
  return cell.state != CellState::unknown;
}

/// Finishes the maps one by one and takes those of which the crop holds something.
GridExportSummary finish_levels(StoreyMaps cast,
                                const GridSurvey& survey,
                                const std::vector<fs::path>& stems,
                                const GridExportOptions& options) {
  GridExportSummary summary;
  summary.no_returns = cast.no_returns;
  summary.floor_seen = !options.floor_reference || survey.sensor_height > 0.0;
  for (std::uint32_t level = 0; level < survey.level_count; ++level) {
    ExportedGrid grid;
    grid.level = level;
    const std::vector<PlanPath> stretches = plans_of(survey.stretches_on(level));
    for (const PlanPath& stretch : stretches) grid.scans += stretch.size();
    grid.map = finished(std::exchange(cast.maps[level], {}), options, stretches);
    grid.yaml = grid_file_paths(stems[level], options.mode).back();
    if (options.crop && std::ranges::none_of(grid.map.cells, is_known)) {
      ++summary.levels_outside;
    } else {
      summary.levels.push_back(std::move(grid));
    }
  }
  if (summary.levels.empty()) throw usage_error("crop: nothing was seen in it");
  return summary;
}

std::string contents_of(const GridSurvey& survey, const std::vector<ExportedGrid>& grids) {
  std::string yaml = "# maps of the storeys, from the lowest up; mean height of the floor [m]\n";
  yaml += "levels:\n";
  for (const ExportedGrid& grid : grids) {
    char height[32];
    std::snprintf(height, sizeof(height), "%.2f", survey.height_of(grid.level));
    yaml += "  - {level: " + std::to_string(grid.level) + ", height: " + height +
            ", map: " + yaml_quoted(grid.yaml.filename().string()) + "}\n";
  }
  return yaml;
}

void write_all(const fs::path& stem,
               const GridSurvey& survey,
               const std::vector<fs::path>& stems,
               const std::vector<ExportedGrid>& grids,
               const GridExportOptions& options) {
  std::vector<WholeFile> files;
  for (const ExportedGrid& grid : grids) {
    const fs::path& name = stems[grid.level];
    for (WholeFile& file :
         grid_files(grid.map, options.mode, name, comments(options, survey.level_from_map))) {
      files.push_back(std::move(file));
    }
    const std::vector<PlanPath> stretches = plans_of(survey.stretches_on(grid.level));
    files.push_back({look_path(name), png_bytes(draw_grid(grid.map, stretches))});
  }
  if (stems.size() > 1) files.push_back({contents_path(stem), contents_of(survey, grids)});
  write_whole_files(files);
}

}  // namespace

GridExportSummary export_grid(const Session& session,
                              const fs::path& stem,
                              const GridExportOptions& options,
                              ThreadPool& pool,
                              const ExportProgress& progress) {
  require_options(options);
  require_grid_target(stem, 1, options);
  const GridSurvey survey = survey_session(session, options, progress);
  require_grid_target(stem, survey.level_count, options);
  const std::vector<fs::path> stems = level_stems(stem, survey.level_count);
  GridExportSummary summary =
      finish_levels(cast_rays(session, options, survey, pool, progress), survey, stems, options);
  write_all(stem, survey, stems, summary.levels, options);
  return summary;
}

}  // namespace kissmap
