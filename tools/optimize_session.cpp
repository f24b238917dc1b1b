// SPDX-License-Identifier: MIT
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <limits>

#include "commands.hpp"
#include "kissmap/error.hpp"
#include "kissmap/formats/graph_edits.hpp"
#include "kissmap/formats/product_folder.hpp"
#include "kissmap/formats/session_update.hpp"
#include "kissmap/loop_closing/loop_editor.hpp"
#include "paths.hpp"
#include "report.hpp"

namespace kissmap {
namespace {

void require_options(const OptimizeCommand& command) {
  if (!command.graph_option.empty()) {
    throw usage_error(command.graph_option +
                      ": is for .g2o files; a session is optimised as 'kissmap run' does it");
  }
  if (command.overwrite && command.output.empty()) {
    throw usage_error("--overwrite: is for -o; without, the session is changed in place");
  }
}

void require_output(const OptimizeCommand& command, const SessionEvidence& session) {
  if (command.output.empty()) return;
  require_apart(command.input, "the session being read,", command.output);
  require_apart(command.output, "the new session", command.input);
  require_apart(session.manifest.log.path, "the log", command.output);
}

/// Those asked for, or else those the session keeps.
GraphEdits edits_for(const OptimizeCommand& command, const SessionEvidence& session) {
  if (!command.edits.empty()) return read_graph_edits(command.edits);
  return session.edits.empty() ? GraphEdits{} : read_graph_edits(session.edits);
}

std::uint32_t local_map_id(std::int64_t id) {
  if (id <= std::numeric_limits<std::uint32_t>::max()) return static_cast<std::uint32_t>(id);
  throw Error(Fault::input, "there is no local map " + std::to_string(id));
}

void apply(const GraphEdit& edit, LoopEditor& editor) {
  const std::uint32_t from = local_map_id(edit.from);
  const std::uint32_t to = local_map_id(edit.to);
  switch (edit.verb) {
    case GraphEdit::Verb::remove:
      return editor.remove(from, to);
    case GraphEdit::Verb::fix:
      return editor.fix(from, to);
    case GraphEdit::Verb::add:
      break;
  }
  if (edit.from_from_to && !edit.is_guess) {
    editor.add(from, to, *edit.from_from_to, {edit.sigma_metres, edit.sigma_radians});
  } else {
    editor.join(from, to, edit.from_from_to);
  }
}

// The library knows no files.
void apply(const GraphEdits& edits, LoopEditor& editor) {
  for (const GraphEdit& edit : edits.edits) {
    try {
      apply(edit, editor);
    } catch (const Error& error) {
      if (error.fault() != Fault::input) throw;
      throw edits.error(edit, error.what());
    }
  }
}

LoopCorrection solve(LoopEditor& editor, const std::filesystem::path& session) {
  try {
    return editor.correction();
  } catch (const Error& error) {
    if (error.fault() != Fault::input) throw;
    throw input_error(session, error.what());
  }
}

SessionUpdate make_update(const SessionEvidence& session, const GraphEdits& edits) {
  const Configuration configuration = configuration_of_session(session.path);
  SessionUpdate update;
  if (!configuration.loop_closing.enabled && edits.edits.empty()) return update;
  std::vector<ScanPlace> places;
  for (const SessionScan& scan : session.scans) {
    places.push_back({scan.mapped.local_map_id, scan.mapped.local_map_from_lidar});
  }
  LoopEditor editor(
      session.loops,
      std::move(places),
      configuration.loop_closing.validation,
      configuration.local_maps.voxel_size,
      [&session](std::uint32_t id) { return read_local_map_surfels(session.path, id); });
  apply(edits, editor);
  update.correction = solve(editor, session.path);
  if (!edits.edits.empty()) update.edits = edits.text;
  return update;
}

/// What was changed by hand, and what became of it.
std::string describe_edits(const std::vector<Closure>& closures) {
  std::string lines;
  for (const Closure& closure : closures) {
    const bool by_hand = closure.trusted || closure.source == ClosureSource::hand ||
                         closure.verdict == ClosureVerdict::removed_by_hand;
    if (!by_hand) continue;
    const bool accepted = closure.verdict == ClosureVerdict::accepted;
    lines += text("    %-10s%u %u: %s",
                  accepted ? "closed" : "refused",
                  closure.query_id,
                  closure.reference_id,
                  reason(closure).c_str());
    if (closure.verdict == ClosureVerdict::refused_by_graph) {
      lines +=
          text("; 'fix %u %u' after the add makes it hold", closure.query_id, closure.reference_id);
    }
    lines += "\n";
  }
  return lines;
}

struct Motion {
  double mean = 0.0;      ///< m
  double farthest = 0.0;  ///< m
};

Motion motion_of(const SessionEvidence& session, const SessionUpdate& update) {
  Motion motion;
  if (!update.correction || session.scans.empty()) return motion;
  for (std::size_t i = 0; i < session.scans.size(); ++i) {
    const Rigid3& before = session.scans[i].mapped.map_from_lidar;
    const Rigid3& after = update.correction->map_from_lidar[i];
    const double distance = (before.translation - after.translation).norm();
    motion.farthest = std::max(motion.farthest, distance);
    motion.mean += distance / static_cast<double>(session.scans.size());
  }
  return motion;
}

void report(const SessionUpdate& update,
            const Motion& motion,
            const std::filesystem::path& written,
            double seconds) {
  std::printf("%s\n", written.c_str());
  if (update.correction) {
    std::fputs(describe_loops(update.correction->closures).c_str(), stdout);
    std::fputs(describe_edits(update.correction->closures).c_str(), stdout);
    std::printf(
        "  moved       scans by %.3f m on average, %.3f m at most\n", motion.mean, motion.farthest);
  } else {
    std::printf("  loops       left open, as by --no-loop-closing; edits may add closures\n");
  }
  if (!update.edits.empty())
    std::printf("  edits       kept in %s\n", (written / "edits.txt").c_str());
  std::printf("  time        %.1f s\n", seconds);
  std::printf("  look at     %s\n", (written / "map.png").c_str());
}

}  // namespace

void optimize_session(const OptimizeCommand& command) {
  using Clock = std::chrono::steady_clock;
  const auto begin = Clock::now();
  require_options(command);
  const SessionEvidence session = read_session_evidence(command.input);
  require_output(command, session);
  const SessionUpdate update = make_update(session, edits_for(command, session));
  const Motion motion = motion_of(session, update);
  bool products_removed = false;
  if (command.output.empty()) {
    if (motion.farthest > 0.0) products_removed = remove_products(command.input);
    update_session(session, update);
  } else {
    copy_session(session, update, command.output, command.overwrite);
  }
  if (command.quiet) return;
  report(update,
         motion,
         command.output.empty() ? command.input : command.output,
         std::chrono::duration<double>(Clock::now() - begin).count());
  if (products_removed) {
    std::printf(
        "  products    removed, they showed the map of before; make them anew with "
        "'kissmap products'\n");
  }
}

}  // namespace kissmap
