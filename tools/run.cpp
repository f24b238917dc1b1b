// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cstdio>
#include <iterator>
#include <utility>

#include "commands.hpp"
#include "kissmap/error.hpp"
#include "kissmap/formats/pictures.hpp"
#include "kissmap/formats/registry.hpp"
#include "kissmap/loop_closing/trajectory_refinement.hpp"
#include "kissmap/version.hpp"
#include "map_log.hpp"
#include "progress.hpp"
#include "report.hpp"

namespace kissmap {
namespace {

SessionManifest manifest_of(const RunCommand& command,
                            const Configuration& configuration,
                            const LogInfo& log) {
  SessionManifest manifest;
  manifest.program_version = version();
  manifest.log.path = (std::filesystem::absolute(log.path) / "").lexically_normal().parent_path();
  manifest.log.format = log.format;
  manifest.log.stamp_source = log.stamp_source;
  manifest.log.read_options = configuration.log;
  manifest.log.selection = command.selection;
  manifest.configuration = to_toml(configuration);
  return manifest;
}

void report(const RunCommand& command,
            const SessionManifest& manifest,
            const MappedLog& mapped,
            const LoopCloser& loops,
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
  if (!loops.closures().empty()) {
    const auto closed =
        std::ranges::count(loops.closures(), ClosureVerdict::accepted, &Closure::verdict);
    std::printf("  loops       %s closed, of %s candidates\n",
                with_commas(static_cast<std::uint64_t>(closed)).c_str(),
                with_commas(loops.closures().size()).c_str());
  }
  std::printf("  time        %.1f s, %.1f scans/s", seconds, scans / seconds);
  if (mapped.log_seconds > 0.0) {
    std::printf(", %.1f times real time", mapped.log_seconds / seconds);
  }
  std::printf("\n");
  if (manifest.pack) std::printf("  pack        %s\n", describe(*manifest.pack).c_str());
  std::fputs(describe_refusals(mapped.counts).c_str(), stdout);
  std::printf("  look at     %s\n", (command.session / "map.png").c_str());
}

/// Replacing a session must not take the log with it.
void require_apart(const std::filesystem::path& log, const std::filesystem::path& session) {
  std::error_code unresolved;
  const auto whole_log = std::filesystem::weakly_canonical(log, unresolved);
  const auto whole_session = std::filesystem::weakly_canonical(session, unresolved);
  for (auto folder = whole_log; folder.has_relative_path(); folder = folder.parent_path()) {
    if (folder != whole_session) continue;
    throw usage_error(session.string() + ": holds the log " + log.string() +
                      "; give another place for the session with -o");
  }
}

/// The last part of a run: corrects what odometry found.
void close_loops(const std::vector<ScanPlace>& places,
                 const LoopClosingOptions& options,
                 LoopCloser& loops,
                 SessionWriter& session) {
  if (!options.enabled) return;
  loops.look_again();
  SessionCorrection correction;
  correction.closures = loops.closures();
  correction.graph = loops.graph();
  correction.edge_weights = loops.edge_weights();
  std::vector<Closure> accepted;
  std::ranges::copy_if(correction.closures, std::back_inserter(accepted), [](const Closure& c) {
    return c.verdict == ClosureVerdict::accepted;
  });
  RefinedTrajectory refined =
      refine_trajectory(places, loops.map_from_local_map(), accepted, loops.neighbors());
  correction.map_from_lidar = std::move(refined.map_from_lidar);
  correction.map_from_local_map = std::move(refined.map_from_local_map);
  session.correct(correction);
}

void write_session(const RunCommand& command,
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
  double seconds = 0.0;
  {
    ProgressLine line(!command.quiet);
    const auto show = [&line](const RunProgress& progress) { line.show(progress); };
    mapped = map_log(log, mapper, {session, loops, pack ? &*pack : nullptr}, show);
    close_loops(mapped.places, configuration.loop_closing, loops, session);
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
  if (!command.quiet) report(command, manifest, mapped, loops, seconds);
}

}  // namespace

void run(const RunCommand& command) {
  Configuration configuration = command.configuration.configuration();
  if (command.no_loop_closing) configuration.loop_closing.enabled = false;
  require_valid(command.selection);
  require_apart(command.log, command.session);
  const auto log = read_ahead(
      select_scans(open_log(command.log, configuration.log, command.format), command.selection));
  if (!command.quiet) {
    for (const std::string& note : log->info().notes) std::printf("note: %s\n", note.c_str());
  }
  SessionWriter session(command.session, command.overwrite);
  try {
    write_session(command, configuration, *log, session);
  } catch (const Error& error) {
    throw Error(error.fault(),
                std::string(error.what()) + "\n  what was written so far is in " +
                    session.partial_path().string());
  }
}

}  // namespace kissmap
