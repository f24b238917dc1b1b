// SPDX-License-Identifier: MIT
#include <cstdio>

#include "commands.hpp"
#include "export_options.hpp"
#include "kissmap/error.hpp"
#include "paths.hpp"
#include "progress.hpp"
#include "report.hpp"

namespace kissmap {
namespace {

constexpr double localization_z_max = 0.2;    // m
constexpr int navigation_min_weak_group = 2;  // cells

std::filesystem::path stem_of(const std::filesystem::path& output) {
  const std::string ending = output.extension().string();
  const bool known = ending == ".yaml" || ending == ".pgm" || ending == ".png";
  std::filesystem::path stem = output;
  if (known) stem.replace_extension();
  if (!stem.has_filename()) {
    throw usage_error(output.string() + ": name the map, as in -o maps/hall");
  }
  std::error_code code;
  const std::filesystem::path folder = stem.parent_path();
  if (!folder.empty() && !std::filesystem::is_directory(folder, code)) {
    throw output_error(folder, "no such folder; make it first");
  }
  return stem;
}

}  // namespace

GridExportOptions grid_options(const ExportGridCommand& command, const Session& session) {
  const Configuration configuration = configuration_of_session(session.path);
  GridExportOptions options;
  options.min_range = configuration.odometry.min_range;
  options.max_range = configuration.odometry.max_range;
  const bool localizes = command.purpose == "localization";
  if (localizes) {
    options.z_max = localization_z_max;
    options.belief = localization_belief;
  }
  options.belief.no_return_range = command.no_return_range;
  if (command.z_min) options.z_min = *command.z_min;
  if (command.z_max) options.z_max = *command.z_max;
  options.resolution = command.resolution;
  options.floor_reference = command.floor_reference;
  options.mode = command.mode == "scale" ? GridMode::scale : GridMode::trinary;
  options.rule = command.rule;
  options.rule.threshold =
      command.threshold.value_or(localizes ? localization_threshold : navigation_threshold);
  options.min_group = command.min_group.value_or(0);
  if (!localizes && !command.min_group) options.min_weak_group = navigation_min_weak_group;
  options.half_width = command.half_width;
  options.connected = command.connected;
  options.align_axes = command.align_axes;
  if (command.crop.size() == 4) {
    options.crop = Eigen::AlignedBox2d(Eigen::Vector2d(command.crop[0], command.crop[1]),
                                       Eigen::Vector2d(command.crop[2], command.crop[3]));
  }
  options.max_memory = bytes_of(command.max_memory);
  options.overwrite = command.overwrite;
  options.moved_log = command.log;
  return options;
}

std::string describe(const ExportedGrid& grid) {
  std::size_t free = 0;
  std::size_t occupied = 0;
  for (const GridCell& cell : grid.map.cells) {
    free += cell.state == CellState::free ? 1 : 0;
    occupied += cell.state == CellState::occupied ? 1 : 0;
  }
  const double area = grid.map.resolution * grid.map.resolution;
  return text("%d x %d cells of %g m, %.1f m2 free, %.1f m2 occupied, from %s scans",
              grid.map.width,
              grid.map.height,
              grid.map.resolution,
              static_cast<double>(free) * area,
              static_cast<double>(occupied) * area,
              with_commas(grid.scans).c_str());
}

void export_grid(const ExportGridCommand& command) {
  const std::filesystem::path stem = stem_of(command.output);
  const Session session = read_session(command.session);
  const GridExportOptions options = grid_options(command, session);
  // Of the map's files: its bare name may well be that of a folder beside it.
  std::filesystem::path yaml = stem;
  yaml += ".yaml";
  require_outside(yaml, command.session, "the session");
  require_outside(yaml, command.log.empty() ? session.manifest.log.path : command.log, "the log");
  ProgressLine line(!command.quiet);
  ThreadPool pool(command.threads);
  const GridExportSummary summary = export_grid(
      session,
      stem,
      options,
      pool,
      [&line](const char* what, std::uint64_t done, std::uint64_t of) {
        line.show(
            text("%s: %s/%s scans", what, with_commas(done).c_str(), with_commas(of).c_str()));
      });
  if (command.quiet) return;
  for (const ExportedGrid& grid : summary.levels) {
    std::printf("%s\n  %s\n", printable(grid.yaml.string()).c_str(), describe(grid).c_str());
  }
  if (summary.levels_outside > 0) {
    std::printf("  note: of %u more levels nothing was seen in the crop; they are not written\n",
                summary.levels_outside);
  }
  if (!summary.floor_seen) {
    std::printf(
        "  note: no floor was seen under the path; heights are above the level of the start\n");
  }
  std::fputs(describe_no_returns(command.no_return_range, summary.no_returns).c_str(), stdout);
  std::printf("  time        %.1f s\n", line.seconds());
}

}  // namespace kissmap
