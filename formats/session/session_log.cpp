// SPDX-License-Identifier: MIT
#include <system_error>

#include "formats/files/output_file.hpp"
#include "formats/session/manifest_json.hpp"
#include "formats/session/pack_log.hpp"
#include "formats/session/session_folder.hpp"
#include "formats/session/verified_log.hpp"
#include "kissmap/error.hpp"
#include "kissmap/formats/pack.hpp"
#include "kissmap/formats/registry.hpp"
#include "kissmap/formats/session.hpp"

namespace kissmap {
namespace {

std::unique_ptr<ScanLog> open_pack(const Session& session) {
  const std::filesystem::path file = session.path / pack_file_name;
  std::error_code code;
  const std::uint64_t size = std::filesystem::file_size(file, code);
  if (code || size != session.manifest.pack->bytes) {
    throw input_error(file,
                      "is missing or not the pack the session was given; make it again with "
                      "'kissmap pack', or restore it from a copy");
  }
  return open_packed(session.path, {});
}

std::unique_ptr<ScanLog> open_recorded_log(const Session& session,
                                           const std::filesystem::path& moved_to) {
  const LogIdentity& identity = session.manifest.log;
  const std::filesystem::path& path = moved_to.empty() ? identity.path : moved_to;
  std::error_code code;
  if (!std::filesystem::exists(path, code)) {
    throw input_error(path,
                      "the log of session '" + session.path.string() +
                          "' is not there; say with --log where it is now");
  }
  auto log = open_log(path, identity.read_options, identity.format);
  return verify_log(select_scans(std::move(log), identity.selection), identity.files);
}

PackSummary write_pack(ScanLog& log, const std::filesystem::path& path) try {
  PackWriter writer(path);
  while (const std::optional<LogEntry> entry = log.next()) writer.add(*entry);
  writer.finish();
  return {writer.bytes(), writer.points(), pack_resolution};
} catch (...) {
  std::error_code ignored;  // the first error is the one to tell
  std::filesystem::remove(path, ignored);
  throw;
}

}  // namespace

std::unique_ptr<ScanLog> open_session_log(const Session& session,
                                          const std::filesystem::path& moved_to) {
  return session.manifest.pack ? open_pack(session) : open_recorded_log(session, moved_to);
}

// Always from the log itself, so that a damaged pack can be made again. A stop between the two
// renames leaves a pack the manifest does not know: the log still serves.
PackSummary pack_session(const std::filesystem::path& session,
                         const std::filesystem::path& moved_to) {
  const FolderLock lock(session);
  lock.require();
  const Session opened = read_session(session);
  const auto log = read_ahead(open_recorded_log(opened, moved_to));
  const std::filesystem::path file = session / pack_file_name;
  const PackSummary summary = write_pack(*log, aside(file));
  rename_path(aside(file), file);
  StoredManifest stored = read_manifest(session);
  stored.manifest.pack = summary;
  write_manifest(stored, session);
  sync_folder(session);
  return summary;
}

}  // namespace kissmap
