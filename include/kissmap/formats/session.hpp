// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "kissmap/formats/scan_log.hpp"
#include "kissmap/loop_closing/loop_correction.hpp"
#include "kissmap/mapping/local_map.hpp"
#include "kissmap/mapping/stamp_gaps.hpp"

namespace kissmap {

/// Version of the layout described in formats/session/FORMAT.md.
inline constexpr int session_format_version = 2;

/// Where a session's scans came from.
struct LogIdentity {
  std::filesystem::path path;  ///< absolute, as it was when the session was made
  std::string format;
  std::string stamp_source;
  ReadOptions read_options;
  ScanSelection selection;
  std::vector<LogFile> files;
};

/// Scans left out, by reason, with the first few for the user to look at.
struct Refusals {
  std::uint64_t count = 0;
  std::vector<std::string> examples;  ///< at most max_refusal_examples, "name: detail"
};
inline constexpr std::size_t max_refusal_examples = 5;

struct SessionCounts {
  std::uint64_t scans_read = 0;  ///< entries taken from the log, used or refused
  std::uint64_t scans_used = 0;
  std::map<std::string, Refusals> scans_refused;  ///< by reason
  std::uint64_t scans_not_converged = 0;
  std::uint64_t points_read = 0;          ///< usable returns in used scans
  std::uint64_t points_out_of_range = 0;  ///< of these, nearer than min or farther than max range
  DroppedReturns points_dropped;          ///< by readers
  std::vector<StampGap> gaps;
};

/// The scans stored inside a session, see `pack_writer.hpp`.
struct PackSummary {
  std::uint64_t bytes = 0;
  std::uint64_t points = 0;
  double resolution = 0.0;  ///< m, quantisation step of a coordinate
};

/// session.json: all about a session that is not a table or a map.
struct SessionManifest {
  int format_version = session_format_version;
  std::string program_version;
  LogIdentity log;
  std::string configuration;  ///< effective configuration, the text of config.toml
  SessionCounts counts;
  double path_length = 0.0;  ///< m
  std::optional<PackSummary> pack;
};

/// A scan of a session: its row of scans.csv.
struct SessionScan {
  std::uint64_t log_index = 0;
  MappedScan mapped;
};

/// A finished session, without the points of its local maps.
struct Session {
  std::filesystem::path path;
  SessionManifest manifest;
  std::vector<SessionScan> scans;
  std::vector<LocalMap> local_maps;  ///< surfels empty, see read_local_map_surfels
  bool corrected = false;            ///< loops were looked for, or closed by hand
  std::vector<Closure> closures;     ///< candidates, accepted or not; information left out
};

/// Writes a session as the scans come; memory grows by 8 bytes a scan. All goes to
/// PATH.partial, which gets its name in finish(). Destroyed without finish(), PATH.partial stays
/// for inspection. Not thread safe. Every member throws Error(output) naming the file.
class SessionWriter {
 public:
  /// Refuses a path that exists, unless `overwrite` and it is a session; a stale PATH.partial
  /// that holds nothing but session files is replaced.
  SessionWriter(const std::filesystem::path& path, bool overwrite);
  ~SessionWriter();

  /// Notes what is known before the end (log, configuration), so that a run that stops early
  /// leaves a folder that says what it was. May be called again; finish() overrules it.
  void describe(const SessionManifest& manifest);

  /// Scans in the order of the log; local maps count from 0 and may come after their scans.
  void add_scan(const SessionScan& scan);
  void add_local_map(const LocalMap& local_map);

  /// Places the scans and local maps anew: their poses by odometry stay in the tables, but all
  /// readers take these. Call after the last scan and local map, before finish(), or never.
  void correct(const LoopCorrection& correction);

  /// The folder being written, for pictures and packs that belong inside it.
  const std::filesystem::path& partial_path() const;

  /// Writes trajectories, config.toml and session.json, flushes all to disk, then renames.
  void finish(const SessionManifest& manifest);

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

/// True if `path` is a folder with a session.json, finished or not. Never throws.
bool is_session(const std::filesystem::path& path);

/// Throws Error(input) naming file, line and cure; a newer format version or a session that was
/// never finished is such an error.
Session read_session(const std::filesystem::path& path);

/// Throws Error(input) naming the first local map whose file is not there.
void require_local_maps(const Session& session);

/// The surfels of one local map of a session, in the local_map frame.
SurfelCloud read_local_map_surfels(const std::filesystem::path& session, std::uint32_t id);

/// Levels a session's map: the rotation about x and y and the shift along z that bring the ground
/// plane of its first local map to z = 0; heading and origin stay. Identity if it has no ground.
Rigid3 level_from_map(const Session& session);

/// Opens the log a session was made from, restricted to the scans it selected. A pack inside the
/// session serves first; otherwise `moved_to` (--log) or the recorded path. Throws Error(input)
/// when the log is missing or changed: names and sizes are compared at once, content hashes as
/// the files are read.
std::unique_ptr<ScanLog> open_session_log(const Session& session,
                                          const std::filesystem::path& moved_to = {});

/// Adds the pack `session/packed_log.kmpack` to a finished session from its log, and updates the
/// manifest. Returns what it cost. Replaces nothing until the pack is complete.
PackSummary pack_session(const std::filesystem::path& session,
                         const std::filesystem::path& moved_to = {});

}  // namespace kissmap
