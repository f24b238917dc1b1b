// SPDX-License-Identifier: MIT
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <optional>

#include "commands.hpp"
#include "kissmap/error.hpp"
#include "kissmap/formats/evaluation_report.hpp"
#include "kissmap/formats/grid_files.hpp"
#include "kissmap/formats/session_replay.hpp"
#include "kissmap/grid/band_mapper.hpp"
#include "kissmap/grid/levels.hpp"
#include "kissmap/grid/wall_direction.hpp"
#include "paths.hpp"
#include "progress.hpp"
#include "report.hpp"

namespace kissmap {
namespace {

constexpr double floor_cell = 0.25;   // m
constexpr double floor_reach = 25.0;  // m

/// What is known of a session before rays are cast.
struct Survey {
  Rigid3 level_from_map;
  SensorPath path;  ///< of the scans, level frame
  std::vector<FloorSample> samples;
  double sensor_height = 0.0;         ///< m above the floor; 0: no floor seen
  double mean_range = 0.0;            ///< m
  std::vector<std::uint32_t> levels;  ///< of the scans
  std::uint32_t level_count = 1;
};

Rigid3 turned_along_walls(const Session& session, const Rigid3& level_from_map) {
  std::vector<Eigen::Vector3f> normals;
  for (const LocalMap& local_map : session.local_maps) {
    const Eigen::Matrix3f rotation =
        (level_from_map.rotation * local_map.map_from_local_map.rotation)
            .toRotationMatrix()
            .cast<float>();
    for (const Eigen::Vector3f& normal :
         read_local_map_surfels(session.path, local_map.id).normals) {
      normals.emplace_back(rotation * normal);
    }
  }
  Rigid3 aligned;
  aligned.rotation = Eigen::AngleAxisd(-wall_direction(normals), Eigen::Vector3d::UnitZ());
  return aligned * level_from_map;
}

class GridExport {
 public:
  GridExport(const ExportGridCommand& command, const Session& session, ProgressLine& line)
      : command_(command),
        session_(session),
        configuration_(configuration_of_session(session.path)),
        line_(line),
        pool_(command.threads) {}

  Survey survey() {
    Survey survey;
    survey.level_from_map = level_from_map(session_);
    if (command_.align_axes) {
      survey.level_from_map = turned_along_walls(session_, survey.level_from_map);
    }
    FloorSampler sampler(floor_cell, floor_reach);
    double range_sum = 0.0;
    std::uint64_t points = 0;
    for_each_scan("looking for the floor", [&](const PlacedScan& scan) {
      if (command_.floor_reference) sampler.add(scan, survey.level_from_map);
      survey.path.push_back(survey.level_from_map * scan.map_from_lidar.translation);
      for (const Eigen::Vector3f& point : scan.points)
        range_sum += static_cast<double>(point.norm());
      points += scan.points.size();
    });
    survey.mean_range = points == 0 ? 0.0 : range_sum / static_cast<double>(points);
    survey.samples = sampler.samples();
    survey.sensor_height = sensor_height(survey.path, survey.samples, floor_cell);
    survey.levels.assign(survey.path.size(), 0);
    if (command_.floor_reference) survey.levels = levels_of(survey.path);
    if (!survey.levels.empty()) survey.level_count = *std::ranges::max_element(survey.levels) + 1;
    return survey;
  }

  double max_range() const { return configuration_.odometry.max_range; }

  GridMap map_level(const Survey& survey, std::uint32_t level, const GridBand& band) {
    SensorPath path;
    std::vector<Eigen::Vector2d> plan;
    for (std::size_t i = 0; i < survey.path.size(); ++i) {
      if (survey.levels[i] != level) continue;
      path.push_back(survey.path[i]);
      plan.emplace_back(survey.path[i].head<2>());
    }
    const FloorMap floor = survey.sensor_height > 0.0
                               ? floor_under(path, survey.samples, floor_cell, survey.sensor_height)
                               : FloorMap();
    BandMapper mapper(floor, band, {});
    const std::string what =
        survey.level_count > 1 ? text("casting rays, level %u", level) : "casting rays";
    for_each_scan(what, [&](const PlacedScan& scan) {
      if (survey.levels[scan.scan_idx] == level) mapper.add(scan, survey.level_from_map, pool_);
    });
    GridMap map = mapper.grid(command_.rule);
    if (command_.min_group > 0) remove_small_groups(command_.min_group, map);
    if (command_.connected) keep_connected_free(plan, map);
    if (command_.crop.size() == 4) {
      return cropped(map,
                     {Eigen::Vector2d(command_.crop[0], command_.crop[1]),
                      Eigen::Vector2d(command_.crop[2], command_.crop[3])});
    }
    return trimmed(map, 2);
  }

 private:
  template <typename Call>
  void for_each_scan(const std::string& what, const Call& call) {
    SessionReplay replay(session_,
                         configuration_.odometry.min_range,
                         configuration_.odometry.max_range,
                         command_.log);
    while (const std::optional<PlacedScan> scan = replay.next()) {
      call(*scan);
      line_.show(text("%s: %llu/%llu scans",
                      what.c_str(),
                      static_cast<unsigned long long>(scan->scan_idx + 1),
                      static_cast<unsigned long long>(replay.size())));
    }
  }

  const ExportGridCommand& command_;
  const Session& session_;
  Configuration configuration_;
  ProgressLine& line_;
  ThreadPool pool_;
};

std::filesystem::path stem_of(const std::filesystem::path& output) {
  const std::string ending = output.extension().string();
  const bool known = ending == ".yaml" || ending == ".pgm" || ending == ".png";
  std::filesystem::path stem = output;
  if (known) stem.replace_extension();
  if (!stem.has_filename())
    throw usage_error(output.string() + ": name the map, as in -o maps/hall");
  return stem;
}

std::filesystem::path with_suffix(std::filesystem::path stem, const std::string& suffix) {
  stem += suffix;
  return stem;
}

/// The finer the nearer things are: 0.05 m indoors.
double resolution_for(double mean_range) {
  if (mean_range < 8.0) return 0.05;
  return mean_range < 20.0 ? 0.1 : 0.2;
}

GridBand band_of(const ExportGridCommand& command, const Survey& survey, double max_range) {
  GridBand band;
  band.z_min = command.z_min.value_or(0.1);
  band.z_max = command.z_max.value_or(command.purpose == "localization" ? 0.2 : 1.8);
  band.resolution =
      command.resolution > 0.0 ? command.resolution : resolution_for(survey.mean_range);
  band.max_range = max_range;
  require_valid(band);
  return band;
}

void require_new(const std::vector<std::filesystem::path>& files, bool overwrite) {
  std::error_code code;
  for (const std::filesystem::path& file : files) {
    if (!overwrite && std::filesystem::exists(file, code)) {
      throw usage_error(file.string() + ": exists; add --overwrite to replace it");
    }
  }
}

void require_options(const ExportGridCommand& command) {
  const std::filesystem::path folder = command.output.parent_path();
  std::error_code code;
  if (!folder.empty() && !std::filesystem::is_directory(folder, code)) {
    throw output_error(folder, "no such folder; make it first");
  }
  require_valid(command.rule);
  const std::vector<double>& crop = command.crop;
  if (crop.size() == 4 && !(crop[0] < crop[2] && crop[1] < crop[3])) {
    throw usage_error("--crop: give x and y of the lower corner, then of the upper one [m]");
  }
  if (command.resolution != 0.0 || command.z_min || command.z_max) {
    require_valid(GridBand{command.z_min.value_or(0.1),
                           command.z_max.value_or(std::max(1.8, command.z_min.value_or(0.1) + 0.1)),
                           command.resolution == 0.0 ? 0.05 : command.resolution,
                           100.0});
  }
}

struct Written {
  std::filesystem::path yaml;
  GridMap map;
  std::size_t scans = 0;
};

std::string describe(const Written& written) {
  std::size_t free = 0;
  std::size_t occupied = 0;
  for (const GridCell& cell : written.map.cells) {
    free += cell.state == CellState::free ? 1 : 0;
    occupied += cell.state == CellState::occupied ? 1 : 0;
  }
  const double area = written.map.resolution * written.map.resolution;
  return text("%d x %d cells of %g m, %.1f m2 free, %.1f m2 occupied, from %s scans",
              written.map.width,
              written.map.height,
              written.map.resolution,
              static_cast<double>(free) * area,
              static_cast<double>(occupied) * area,
              with_commas(written.scans).c_str());
}

std::vector<Eigen::Vector2d> plan_of(const Survey& survey, std::uint32_t level) {
  std::vector<Eigen::Vector2d> plan;
  for (std::size_t i = 0; i < survey.path.size(); ++i) {
    if (survey.levels[i] == level) plan.emplace_back(survey.path[i].head<2>());
  }
  return plan;
}

/// Of the YAML: what heights it looks at, and where it lies beside the session's trajectory.
std::vector<std::string> comments(const ExportGridCommand& command,
                                  const Survey& survey,
                                  const GridBand& band) {
  const Eigen::Vector3d& t = survey.level_from_map.translation;
  const Eigen::Quaterniond& q = survey.level_from_map.rotation;
  const char* reference =
      command.floor_reference ? "the floor" : "the level of the first local map's ground";
  return {
      text("%g m to %g m above %s", band.z_min, band.z_max, reference),
      "levelled; from the session's map frame by x y z qx qy qz qw",
      text("%.9g %.9g %.9g %.9g %.9g %.9g %.9g", t.x(), t.y(), t.z(), q.x(), q.y(), q.z(), q.w())};
}

Written write_level(const ExportGridCommand& command,
                    const std::filesystem::path& stem,
                    const Survey& survey,
                    const GridBand& band,
                    std::uint32_t level,
                    GridExport& work) {
  Written written;
  written.map = work.map_level(survey, level, band);
  const std::vector<Eigen::Vector2d> plan = plan_of(survey, level);
  written.scans = plan.size();
  const GridMode mode = command.mode == "scale" ? GridMode::scale : GridMode::trinary;
  write_grid(written.map, mode, stem, comments(command, survey, band));
  write_png(draw_grid(written.map, plan), with_suffix(stem, "_look.png"));
  written.yaml = grid_file_paths(stem, mode).back();
  return written;
}

/// Mean height of the sensor's path over the level of the start.
double height_of(const Survey& survey, std::uint32_t level) {
  double sum = 0.0;
  double count = 0.0;
  for (std::size_t i = 0; i < survey.path.size(); ++i) {
    if (survey.levels[i] != level) continue;
    sum += survey.path[i].z() - survey.sensor_height;
    count += 1.0;
  }
  return sum / count;
}

void write_contents(const std::filesystem::path& file,
                    const Survey& survey,
                    const std::vector<Written>& written) {
  std::string yaml =
      "# maps of the storeys, from the lowest up; height of the floor where the path went "
      "[m]\nlevels:\n";
  for (std::uint32_t level = 0; level < written.size(); ++level) {
    yaml += text("  - {level: %u, height: %.2f, map: \"%s\"}\n",
                 level,
                 height_of(survey, level),
                 written[level].yaml.filename().c_str());
  }
  write_text_file(file, yaml);
}

}  // namespace

void export_grid(const ExportGridCommand& command) {
  require_options(command);
  const Session session = read_session(command.session);
  const std::filesystem::path stem = stem_of(command.output);
  ProgressLine line(!command.quiet);
  GridExport work(command, session, line);
  const Survey survey = work.survey();
  const GridBand band = band_of(command, survey, work.max_range());
  const GridMode mode = command.mode == "scale" ? GridMode::scale : GridMode::trinary;
  std::vector<std::filesystem::path> stems = {stem};
  if (survey.level_count > 1) {
    stems.clear();
    for (std::uint32_t level = 0; level < survey.level_count; ++level) {
      stems.push_back(with_suffix(stem, "_level" + std::to_string(level)));
    }
  }
  std::vector<std::filesystem::path> files;
  for (const std::filesystem::path& each : stems) {
    for (const auto& file : grid_file_paths(each, mode)) files.push_back(file);
    files.push_back(with_suffix(each, "_look.png"));
  }
  require_new(files, command.overwrite);
  std::vector<Written> written;
  for (std::uint32_t level = 0; level < survey.level_count; ++level) {
    written.push_back(write_level(command, stems[level], survey, band, level, work));
  }
  if (written.size() > 1) write_contents(with_suffix(stem, "_levels.yaml"), survey, written);
  if (command.quiet) return;
  for (const Written& each : written) {
    std::printf("%s\n  %s\n", each.yaml.c_str(), describe(each).c_str());
  }
  if (command.floor_reference && survey.sensor_height == 0.0) {
    std::printf(
        "  note: no floor was seen under the path; heights are those above the level of the "
        "start\n");
  }
  std::printf("  time        %.1f s\n", line.seconds());
}

}  // namespace kissmap
