// SPDX-License-Identifier: MIT
#include "formats/files/output_file.hpp"
#include "formats/session/correction_tables.hpp"
#include "formats/session/local_map_ply.hpp"
#include "formats/session/manifest_json.hpp"
#include "formats/session/session_folder.hpp"
#include "formats/session/session_tables.hpp"
#include "kissmap/error.hpp"
#include "kissmap/formats/session.hpp"
#include "kissmap/formats/session_update.hpp"
#include "kissmap/loop_closing/closure_validation.hpp"
#include "kissmap/loop_closing/ground_alignment.hpp"

namespace kissmap {
namespace {

void require_folder(const std::filesystem::path& path) {
  std::error_code code;
  if (std::filesystem::is_directory(path, code)) return;
  if (std::filesystem::is_directory(aside(path), code)) {
    throw input_error(path,
                      "the session was never finished, only '" + aside(path).string() +
                          "' is there; make it again with 'kissmap run'");
  }
  throw input_error(path, "no such session folder; make one with 'kissmap run'");
}

void require_finished(const StoredManifest& stored, const std::filesystem::path& path) {
  if (stored.finished) return;
  if (stored.optimizing) {
    throw input_error(path,
                      "'kissmap optimize' was stopped while it changed the session; run it again, "
                      "with the same --edits if there were any");
  }
  throw input_error(path, "the session was never finished; make it again with 'kissmap run'");
}

void require_rows(std::uint64_t found, std::uint64_t expected, const std::filesystem::path& path) {
  if (found == expected) return;
  throw input_error(path,
                    "holds " + std::to_string(found) + " rows where " + manifest_file_name +
                        " counts " + std::to_string(expected) + "; " + damaged_session_cure);
}

// Figures of run, verdicts of their own; information is not stored because it follows from them.
std::vector<Closure> without_edits(std::vector<Closure> closures) {
  std::erase_if(closures, [](const Closure& c) { return c.source == ClosureSource::hand; });
  for (Closure& closure : closures) {
    closure.verdict = closure.first_verdict;
    closure.trusted = false;
    closure.information = information_of(closure);
  }
  return closures;
}

}  // namespace

bool is_session(const std::filesystem::path& path) {
  return has_session_manifest(path);
}

Session read_session(const std::filesystem::path& path) {
  require_folder(folder_path(path));
  StoredManifest stored = read_manifest(path);
  require_finished(stored, path);
  Session session;
  session.path = path;
  session.manifest = std::move(stored.manifest);
  session.local_maps = read_local_maps(path);
  require_rows(session.local_maps.size(), stored.tables.local_maps, path / local_maps_file_name);
  for_each_scan(path, session.local_maps, UnclosedScans::refuse, [&](const SessionScan& scan) {
    session.scans.push_back(scan);
  });
  require_rows(session.scans.size(), stored.tables.scans, path / scans_file_name);
  session.corrected = std::filesystem::exists(path / closures_file_name);
  session.closures = read_closures(path, session.local_maps.size());
  require_rows(count_measured(session.closures),
               stored.tables.closures.value_or(count_measured(session.closures)),
               path / closures_file_name);
  return session;
}

SessionEvidence read_session_evidence(const std::filesystem::path& path) {
  require_folder(folder_path(path));
  StoredManifest stored = read_manifest(path);
  if (!stored.optimizing) require_finished(stored, path);
  if (!stored.tables.closures || !stored.tables.neighbors) {
    throw input_error(path,
                      "was made by a kissmap that did not keep all it measured of loops; make it "
                      "again with 'kissmap run'");
  }
  SessionEvidence evidence;
  evidence.path = folder_path(path);
  evidence.manifest = std::move(stored.manifest);
  evidence.local_maps = read_odometry_local_maps(path);
  require_rows(evidence.local_maps.size(), stored.tables.local_maps, path / local_maps_file_name);
  for_each_scan(path, evidence.local_maps, UnclosedScans::refuse, [&](const SessionScan& scan) {
    evidence.scans.push_back(scan);
  });
  require_rows(evidence.scans.size(), stored.tables.scans, path / scans_file_name);
  LoopEvidence& loops = evidence.loops;
  for (const LocalMap& local_map : evidence.local_maps) {
    loops.map_from_local_map.push_back(local_map.map_from_local_map);
    loops.path_lengths.push_back(local_map.path_length);
  }
  loops.closures = without_edits(read_closures(path, evidence.local_maps.size()));
  require_rows(loops.closures.size(), *stored.tables.closures, path / closures_file_name);
  loops.neighbors = read_neighbors(path, evidence.local_maps.size());
  require_rows(loops.neighbors.size(), *stored.tables.neighbors, path / neighbors_file_name);
  loops.surfaces = read_surfaces(path, evidence.scans.size());
  require_rows(
      loops.surfaces.size(), stored.tables.surfaces.value_or(0), path / surfaces_file_name);
  if (std::filesystem::exists(path / edits_file_name)) evidence.edits = path / edits_file_name;
  return evidence;
}

void require_local_maps(const Session& session) {
  for (const LocalMap& local_map : session.local_maps) {
    const std::filesystem::path file = local_map_file(session.path, local_map.id);
    std::error_code code;
    if (std::filesystem::is_regular_file(file, code)) continue;
    throw input_error(file, std::string("is missing; ") + damaged_session_cure);
  }
}

SurfelCloud read_local_map_surfels(const std::filesystem::path& session, std::uint32_t id) {
  return read_surfels(local_map_file(session, id));
}

Rigid3 level_from_map(const Session& session) {
  if (session.local_maps.empty()) return {};
  const SurfelCloud first = read_local_map_surfels(session.path, session.local_maps.front().id);
  const Rigid3 map_from_local_map = session.local_maps.front().map_from_local_map;
  const std::optional<Rigid3> level = ground_from_local_map(first.means);
  return level.value_or(Rigid3{}) * map_from_local_map.inverse();
}

}  // namespace kissmap
