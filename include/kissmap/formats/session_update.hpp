// SPDX-License-Identifier: MIT
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "kissmap/formats/session.hpp"
#include "kissmap/loop_closing/loop_correction.hpp"

namespace kissmap {

/// What the corrected poses of a session follow from.
struct SessionEvidence {
  std::filesystem::path path;
  SessionManifest manifest;
  std::vector<SessionScan> scans;    ///< with the present poses in the map frame
  std::vector<LocalMap> local_maps;  ///< where odometry put them, without surfels
  LoopEvidence loops;                ///< as the run left it, without edits by hand
  std::filesystem::path edits;       ///< the session's own edits.txt; empty if it has none
};

/// Reads a finished session, or one whose update_session() was stopped. Throws Error(input) naming
/// file, line and cure.
SessionEvidence read_session_evidence(const std::filesystem::path& session);

/// All that follows from the evidence and the edits.
struct SessionUpdate {
  std::optional<LoopCorrection> correction;  ///< nothing: loops are left open
  std::string edits;                         ///< text of edits.txt; empty: the session gets none
};

/// Changes a session in place: keyposes, poses, closures, neighbours, graph, trajectories, picture,
/// edits and manifest are those `kissmap run` would have left. All are written aside first; while
/// they are put in place the manifest says that the session is being changed, so that one that was
/// stopped is the old one, the new one, or refused by its readers until this is called again.
/// Throws Error(output) and Error(input) naming the file.
void update_session(const SessionEvidence& session, const SessionUpdate& update);

/// The same in a copy of the session, which appears whole or not at all. Local maps and a pack are
/// copied, not linked. Throws like update_session(), and where SessionWriter would.
void copy_session(const SessionEvidence& session,
                  const SessionUpdate& update,
                  const std::filesystem::path& output,
                  bool overwrite);

}  // namespace kissmap
