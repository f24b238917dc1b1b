// SPDX-License-Identifier: MIT
#include "formats/files/output_file.hpp"
#include "formats/session/correction_tables.hpp"
#include "formats/session/local_map_ply.hpp"
#include "formats/session/manifest_json.hpp"
#include "formats/session/session_folder.hpp"
#include "formats/session/session_tables.hpp"
#include "kissmap/error.hpp"
#include "kissmap/formats/session.hpp"

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

void require_finished(bool finished, const std::filesystem::path& path) {
  if (finished) return;
  throw input_error(path, "the session was never finished; make it again with 'kissmap run'");
}

void require_rows(std::uint64_t found, std::uint64_t expected, const std::filesystem::path& path) {
  if (found == expected) return;
  throw input_error(path,
                    "holds " + std::to_string(found) + " rows where " + manifest_file_name +
                        " counts " + std::to_string(expected) + "; " + damaged_session_cure);
}

}  // namespace

bool is_session(const std::filesystem::path& path) {
  return has_session_manifest(path);
}

Session read_session(const std::filesystem::path& path) {
  require_folder(folder_path(path));
  StoredManifest stored = read_manifest(path);
  require_finished(stored.finished, path);
  Session session;
  session.path = path;
  session.manifest = std::move(stored.manifest);
  session.local_maps = read_local_maps(path);
  require_rows(session.local_maps.size(), stored.tables.local_maps, path / local_maps_file_name);
  for_each_scan(path, session.local_maps, UnclosedScans::refuse, [&](const SessionScan& scan) {
    session.scans.push_back(scan);
  });
  session.closures = read_closures(path, session.local_maps.size());
  require_rows(session.scans.size(), stored.tables.scans, path / scans_file_name);
  return session;
}

SurfelCloud read_local_map_surfels(const std::filesystem::path& session, std::uint32_t id) {
  return read_surfels(local_map_file(session, id));
}

}  // namespace kissmap
