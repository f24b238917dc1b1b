// SPDX-License-Identifier: MIT
#include <chrono>
#include <cstdio>
#include <optional>

#include "commands.hpp"
#include "kissmap/error.hpp"
#include "kissmap/formats/pictures.hpp"
#include "kissmap/formats/registry.hpp"
#include "kissmap/loop_closing/loop_closer.hpp"
#include "kissmap/version.hpp"
#include "map_log.hpp"
#include "paths.hpp"
#include "progress.hpp"
#include "report.hpp"

namespace kissmap {
namespace {

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point begin) {
  return std::chrono::duration<double>(Clock::now() - begin).count();
}

/// ", 8.4 times real time"; empty where the log has no stamps.
std::string real_time(double log_seconds, double seconds) {
  if (!(log_seconds > 0.0)) return {};
  return text(", %.1f times real time", log_seconds / seconds);
}

SessionManifest manifest_of(const RunCommand& command,
                            const Configuration& configuration,
                            const LogInfo& log) {
  SessionManifest manifest;
  manifest.program_version = version();
  manifest.log.path = (std::filesystem::absolute(log.path) / "").lexically_normal().parent_path();
  manifest.log.format = log.format;
  manifest.log.stamp_source = log.stamp_source;
  manifest.log.read_options = configuration.log;
  if (!configuration.log.calibration.empty()) {
    manifest.log.read_options.calibration =
        std::filesystem::absolute(configuration.log.calibration).lexically_normal();
  }
  manifest.log.selection = command.selection;
  manifest.configuration = to_toml(configuration);
  return manifest;
}

void report(const RunCommand& command,
            const SessionManifest& manifest,
            const MappedLog& mapped,
            const std::vector<Closure>& closures,
            double seconds) {
  const auto scans = static_cast<double>(mapped.counts.scans_read);
  std::printf("%s\n", command.session.c_str());
  std::printf("  scans       %s used of %s, stamps from %s\n",
              with_commas(mapped.counts.scans_used).c_str(),
              with_commas(mapped.counts.scans_read).c_str(),
              manifest.log.stamp_source.c_str());
  std::printf("  path        %.1f m in %u local map%s\n",
              mapped.path_length,
              mapped.local_maps,
              mapped.local_maps == 1 ? "" : "s");
  if (!closures.empty()) std::fputs(describe_loops(closures).c_str(), stdout);
  std::printf("  time        %.1f s, %.1f scans/s%s\n",
              seconds,
              scans / seconds,
              real_time(mapped.log_seconds, seconds).c_str());
  if (manifest.pack) std::printf("  pack        %s\n", describe(*manifest.pack).c_str());
  std::fputs(describe_refusals(mapped.counts).c_str(), stdout);
  std::printf("  look at     %s\n", (command.session / "map.png").c_str());
}

/// The last part of a run: corrects what odometry found.
LoopCorrection close_loops(const std::vector<ScanPlace>& places,
                           const StretchRecorder& stretches,
                           LoopCloser& loops,
                           ThreadPool& pool,
                           ProgressLine& line) {
  loops.look_again([&line](int round, std::uint32_t done, std::uint32_t of) {
    line.show(text("second look for loops, round %d: %u/%u local maps", round + 1, done, of));
  });
  line.show("fitting surfaces to each other");
  LoopEvidence evidence = loops.evidence();
  LoopCorrection correction;
  stretches.link(
      [&](std::span<const SurfaceLink> links) {
        evidence.surfaces.assign(links.begin(), links.end());
        correction = correct_loops(places, evidence);
        return correction.map_from_lidar;
      },
      pool);
  return correction;
}

/// Returns how long the log took to record [s]; 0 without stamps.
double write_session(const RunCommand& command,
                     const Configuration& configuration,
                     ScanLog& log,
                     SessionWriter& session) {
  SessionManifest manifest = manifest_of(command, configuration, log.info());
  session.describe(manifest);
  std::optional<PackWriter> pack;
  if (command.pack) pack.emplace(session.partial_path() / pack_file_name);
  ThreadPool pool(command.threads);
  Mapper mapper(configuration.odometry, configuration.local_maps, pool);
  const std::filesystem::path folder = session.partial_path();
  LoopCloser loops(configuration.loop_closing,
                   configuration.local_maps.voxel_size,
                   [&folder](std::uint32_t id) { return read_local_map_surfels(folder, id); });
  MappedLog mapped;
  std::optional<LoopCorrection> correction;
  double seconds = 0.0;
  {
    ProgressLine line(!command.quiet);
    const auto show = [&line](const RunProgress& progress) { line.show(progress); };
    std::optional<StretchRecorder> stretches;
    if (configuration.loop_closing.enabled) {
      stretches.emplace(folder, configuration.odometry.min_range, configuration.odometry.max_range);
    }
    mapped = map_log(log,
                     mapper,
                     {session, loops, stretches ? &*stretches : nullptr, pack ? &*pack : nullptr},
                     show);
    if (stretches) {
      correction = close_loops(mapped.places, *stretches, loops, pool, line);
      session.correct(*correction);
    }
    seconds = line.seconds();
  }
  manifest.log.files = log.files();
  manifest.counts = mapped.counts;
  manifest.path_length = mapped.path_length;
  if (pack) {
    pack->finish();
    manifest.pack = PackSummary{pack->bytes(), pack->points(), pack_resolution};
  }
  write_png(draw_map_from_above(session.partial_path()), session.partial_path() / "map.png");
  session.finish(manifest);
  if (!command.quiet) {
    report(command,
           manifest,
           mapped,
           correction ? correction->closures : std::vector<Closure>{},
           seconds);
  }
  return mapped.log_seconds;
}

void write_products(const RunCommand& command) try {
  write_products(ProductsCommand{command.session, {}, command.threads, command.quiet});
} catch (const Error& error) {
  throw Error(error.fault(),
              std::string(error.what()) +
                  "\n  the session is finished, only its products are "
                  "missing: 'kissmap products' makes them");
}

}  // namespace

void run(const RunCommand& command) {
  const auto begin = Clock::now();
  Configuration configuration = command.configuration.configuration();
  if (command.no_loop_closing) configuration.loop_closing.enabled = false;
  require_valid(command.selection);
  require_apart(command.log, "the log", command.session);
  const auto log = read_ahead(
      select_scans(open_log(command.log, configuration.log, command.format), command.selection));
  if (!command.quiet) {
    for (const std::string& note : log->info().notes) std::printf("note: %s\n", note.c_str());
  }
  SessionWriter session(command.session, command.overwrite);
  double log_seconds = 0.0;
  try {
    log_seconds = write_session(command, configuration, *log, session);
  } catch (const Error& error) {
    throw Error(error.fault(),
                std::string(error.what()) + "\n  what was written so far is in " +
                    session.partial_path().string());
  }
  if (command.no_products) return;
  write_products(command);
  if (command.quiet) return;
  const double seconds = seconds_since(begin);
  std::printf("  in all      %.1f s%s\n", seconds, real_time(log_seconds, seconds).c_str());
}

}  // namespace kissmap
