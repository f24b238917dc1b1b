// SPDX-License-Identifier: MIT
#include <cstdio>

#include "commands.hpp"
#include "export_options.hpp"
#include "paths.hpp"
#include "progress.hpp"
#include "report.hpp"

namespace kissmap {
namespace {

void report(const std::filesystem::path& output,
            ProductFrame frame,
            double no_return_range,
            const VoxelExportSummary& summary,
            double seconds) {
  std::printf("%s\n", printable(output.string()).c_str());
  std::printf("  voxels      %s\n", describe(summary).c_str());
  std::printf("  rays        %s of %s scans",
              with_commas(summary.rays).c_str(),
              with_commas(summary.scans).c_str());
  if (summary.skipped_rays > 0) {
    std::printf(", %s skipped", with_commas(summary.skipped_rays).c_str());
  }
  std::printf("\n  memory      %.1f MB at most", 1e-6 * static_cast<double>(summary.peak_memory));
  if (summary.area > 0.0) {
    std::printf(", %.0f bytes for each of %.0f m2 seen from above",
                static_cast<double>(summary.memory) / summary.area,
                summary.area);
  }
  if (summary.passes > 1) {
    std::printf(", %s passes over the log", with_commas(summary.passes).c_str());
  }
  std::printf("\n%s%s",
              describe_frame(frame, summary.frame_from_map).c_str(),
              describe_offset(summary.offset_file).c_str());
  std::fputs(describe_no_returns(no_return_range, summary.no_returns).c_str(), stdout);
  std::printf("  time        %.1f s\n", seconds);
}

}  // namespace

VoxelExportOptions voxel_options(const ExportVoxelsCommand& command, const Session& session) {
  const Configuration configuration = configuration_of_session(session.path);
  VoxelExportOptions options;
  options.min_range = configuration.odometry.min_range;
  options.max_range = configuration.odometry.max_range;
  options.resolution = command.resolution;
  options.threshold = command.threshold;
  options.no_return_range = command.no_return_range;
  options.frame = frame_named(command.frame);
  options.max_memory = bytes_of(command.max_memory);
  options.overwrite = command.overwrite;
  options.moved_log = command.log;
  return options;
}

std::string describe(const VoxelExportSummary& summary) {
  return text("%s occupied, %s free, of %g m",
              with_commas(summary.occupied).c_str(),
              with_commas(summary.free).c_str(),
              summary.resolution);
}

void export_voxels(const ExportVoxelsCommand& command) {
  const Session session = read_session(command.session);
  const VoxelExportOptions options = voxel_options(command, session);
  require_outside(command.output, command.session, "the session");
  require_outside(
      command.output, command.log.empty() ? session.manifest.log.path : command.log, "the log");
  ThreadPool pool(command.threads);
  VoxelExportSummary summary;
  double seconds = 0.0;
  {
    ProgressLine line(!command.quiet);
    summary = export_voxels(
        session,
        command.output,
        options,
        pool,
        [&line](const char* what, std::uint64_t done, std::uint64_t of) {
          line.show(
              text("%s: %s/%s scans", what, with_commas(done).c_str(), with_commas(of).c_str()));
        });
    seconds = line.seconds();
  }
  if (command.quiet) return;
  report(command.output, options.frame, options.no_return_range, summary, seconds);
}

}  // namespace kissmap
