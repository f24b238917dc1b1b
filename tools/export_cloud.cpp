// SPDX-License-Identifier: MIT
#include <charconv>
#include <cmath>
#include <cstdio>
#include <map>
#include <sstream>

#include "commands.hpp"
#include "export_options.hpp"
#include "kissmap/error.hpp"
#include "paths.hpp"
#include "progress.hpp"
#include "report.hpp"

namespace kissmap {
namespace {

constexpr double voxels_per_range = 1000.0;

std::vector<std::string> words_of(const std::string& list) {
  std::vector<std::string> words;
  std::istringstream rest(list);
  for (std::string word; std::getline(rest, word, ',');) words.push_back(word);
  return words;
}

void apply_fields(const std::string& list, CloudExportOptions& options) {
  if (list.empty()) return;
  options.intensity_if_there = false;
  CloudFields& fields = options.fields;
  const std::map<std::string, bool*> known = {{"intensity", &fields.intensity},
                                              {"time", &fields.time},
                                              {"normals", &fields.normals},
                                              {"scan", &fields.scan},
                                              {"sensor", &fields.sensor}};
  for (const std::string& word : words_of(list)) {
    if (word == "none" && list == word) continue;
    const auto found = known.find(word);
    if (found == known.end()) {
      throw usage_error("--fields: '" + word +
                        "' is not one of intensity, time, normals, scan, sensor, or none alone");
    }
    *found->second = true;
  }
}

void apply_crop(const ExportCloudCommand& command, CropRegion& crop) {
  if (!command.crop.empty()) {
    std::vector<double> numbers;
    for (const std::string& word : words_of(command.crop)) {
      const char* end = word.data() + word.size();
      const auto [rest, error] = std::from_chars(word.data(), end, numbers.emplace_back());
      if (error != std::errc{} || rest != end || !std::isfinite(numbers.back())) numbers.clear();
    }
    if (numbers.size() != 4) {
      throw usage_error("--crop: '" + command.crop + "' is not xmin,ymin,xmax,ymax in metres");
    }
    crop.low = {numbers[0], numbers[1]};
    crop.high = {numbers[2], numbers[3]};
  }
  if (!command.crop_polygon.empty()) crop.polygon = read_polygon(command.crop_polygon);
  if (command.z_min) crop.z_min = *command.z_min;
  if (command.z_max) crop.z_max = *command.z_max;
}

std::string list_of(const CloudFields& fields) {
  std::string list = "x y z";
  const auto add = [&list](bool there, const char* name) {
    if (there) list += std::string(" ") + name;
  };
  add(fields.intensity, "intensity");
  add(fields.time, "time");
  add(fields.normals, "normals");
  add(fields.scan, "scan");
  add(fields.sensor, "sensor");
  add(fields.rgb, "color");
  return list;
}

void report(const std::filesystem::path& output,
            const CloudExportOptions& options,
            const CloudExportSummary& summary,
            double seconds) {
  std::printf("%s\n", printable(output.string()).c_str());
  std::printf("  points      %s of %s",
              with_commas(summary.points_written).c_str(),
              with_commas(summary.points_inside).c_str());
  if (options.voxel_size > 0.0) std::printf(", one a voxel of %g m", options.voxel_size);
  std::printf("\n");
  if (options.remove_dynamic) {
    std::printf("  moved       %s points, in %s\n",
                with_commas(summary.moved_points).c_str(),
                printable(summary.moved_file.string()).c_str());
  }
  if (options.remove_outliers) {
    std::printf("  left out    %s voxels that stand alone\n",
                with_commas(summary.outliers).c_str());
  }
  if (summary.tiles > 0) {
    std::printf(
        "  tiles       %s of %d m\n", with_commas(summary.tiles).c_str(), options.tile_size);
  }
  std::printf("  fields      %s\n", list_of(summary.fields).c_str());
  std::printf("%s", describe_frame(options.frame, summary.frame_from_map).c_str());
  std::printf("%s", describe_offset(summary.offset_file).c_str());
  std::printf("  time        %.1f s\n", seconds);
}

}  // namespace

CloudExportOptions cloud_options(const ExportCloudCommand& command, const Session& session) {
  const Configuration configuration = configuration_of_session(session.path);
  CloudExportOptions options;
  options.min_range = configuration.odometry.min_range;
  options.max_range = configuration.odometry.max_range;
  options.voxel_size = command.voxel_size.value_or(options.max_range / voxels_per_range);
  apply_fields(command.fields, options);
  apply_crop(command, options.crop);
  options.fields.rgb = !command.colour.empty();
  options.remove_outliers = command.remove_outliers;
  options.remove_dynamic = command.remove_dynamic;
  options.compress = command.compress;
  options.frame = frame_named(command.frame);
  options.tile_size = command.tile_size;
  options.overwrite = command.overwrite;
  options.moved_log = command.log;
  return options;
}

void export_cloud(const ExportCloudCommand& command) {
  const Session session = read_session(command.session);
  const CloudExportOptions options = cloud_options(command, session);
  require_outside(command.output, command.session, "the session");
  require_outside(
      command.output, command.log.empty() ? session.manifest.log.path : command.log, "the log");
  ThreadPool pool(command.threads);
  CloudExportSummary summary;
  double seconds = 0.0;
  {
    ProgressLine line(!command.quiet);
    summary = export_cloud(
        session,
        command.output,
        options,
        pool,
        [&line](const char* what, std::uint64_t done, std::uint64_t of) {
          line.show(done == 0 ? std::string(what)
                              : std::string(what) + text(" %llu/%llu",
                                                         static_cast<unsigned long long>(done),
                                                         static_cast<unsigned long long>(of)));
        });
    seconds = line.seconds();
  }
  if (!command.quiet) report(command.output, options, summary, seconds);
}

}  // namespace kissmap
