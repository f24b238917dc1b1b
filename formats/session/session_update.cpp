// SPDX-License-Identifier: MIT
#include "kissmap/formats/session_update.hpp"

#include <fstream>
#include <system_error>

#include "formats/files/output_file.hpp"
#include "formats/session/correction_tables.hpp"
#include "formats/session/manifest_json.hpp"
#include "formats/session/session_folder.hpp"
#include "formats/session/session_tables.hpp"
#include "formats/session/trajectory_files.hpp"
#include "kissmap/error.hpp"
#include "kissmap/formats/pack.hpp"
#include "kissmap/formats/pictures.hpp"
#include "kissmap/version.hpp"

namespace kissmap {
namespace {

namespace fs = std::filesystem;

/// The measurements are nowhere else: an update may not lose any.
void require_complete(const SessionEvidence& session, const SessionUpdate& update) {
  const LoopCorrection kept = update.correction.value_or(LoopCorrection{});
  const bool places_all =
      !update.correction || (kept.map_from_lidar.size() == session.scans.size() &&
                             kept.map_from_local_map.size() == session.local_maps.size());
  if (places_all && count_measured(kept.closures) == session.loops.closures.size() &&
      kept.neighbors.size() == session.loops.neighbors.size() &&
      kept.surfaces.size() == session.loops.surfaces.size()) {
    return;
  }
  throw Error(Fault::internal, "an update of a session must keep all that was measured");
}

void write_tables(const fs::path& folder,
                  const SessionEvidence& session,
                  const LoopCorrection& correction) {
  std::vector<std::uint64_t> log_indices;
  std::vector<std::int64_t> stamps_ns;
  for (const SessionScan& scan : session.scans) {
    log_indices.push_back(scan.log_index);
    note_first_stamp(scan.mapped, stamps_ns);
  }
  stamps_ns.resize(session.local_maps.size());
  write_correction(folder, correction, log_indices, stamps_ns);
}

/// Poses of the scans and layout of the picture, corrected if there is a correction.
std::vector<Rigid3> place(const SessionEvidence& session,
                          const std::optional<LoopCorrection>& correction,
                          MapLayout& layout) {
  layout.local_maps = session.local_maps;
  std::vector<Rigid3> map_from_lidar;
  for (std::size_t i = 0; i < session.scans.size(); ++i) {
    const MappedScan& scan = session.scans[i].mapped;
    const LocalMap& own = session.local_maps[scan.local_map_id];
    map_from_lidar.push_back(correction ? correction->map_from_lidar.at(i)
                                        : own.map_from_local_map * scan.local_map_from_lidar);
    layout.trajectory.push_back(map_from_lidar.back().translation);
  }
  if (!correction) return map_from_lidar;
  for (LocalMap& local_map : layout.local_maps) {
    local_map.map_from_local_map = correction->map_from_local_map.at(local_map.id);
  }
  layout.closures = correction->closures;
  return map_from_lidar;
}

void write_derived(const fs::path& folder,
                   const SessionEvidence& session,
                   const SessionUpdate& update) {
  MapLayout layout;
  const std::vector<Rigid3> map_from_lidar = place(session, update.correction, layout);
  if (update.correction) write_tables(folder, session, *update.correction);
  TrajectoryFiles trajectories(folder);
  for (std::size_t i = 0; i < session.scans.size(); ++i) {
    trajectories.add(session.scans[i].mapped.pose_stamp_ns, map_from_lidar[i]);
  }
  trajectories.close();
  write_png(draw_map_from_above(session.path, layout), folder / picture_file_name);
  if (!update.edits.empty()) write_whole_file(folder / edits_file_name, update.edits);
}

/// A folder of ours that is gone at the end of the scope, unless it got another name.
class StagingFolder {
 public:
  explicit StagingFolder(fs::path path) : path_(std::move(path)) { create_partial_folder(path_); }
  ~StagingFolder() {
    std::error_code ignored;  // what is left is replaced by the next update
    fs::remove_all(path_, ignored);
  }
  StagingFolder(const StagingFolder&) = delete;
  StagingFolder& operator=(const StagingFolder&) = delete;

  const fs::path& path() const { return path_; }

 private:
  fs::path path_;
};

void put_in_place(const fs::path& staging, const fs::path& session) {
  for (const char* name : derived_file_names) {
    std::error_code code;
    if (fs::exists(staging / name)) {
      rename_path(staging / name, session / name);
    } else if (fs::remove(session / name, code); code) {
      throw output_error(session / name, "cannot be removed: " + code.message());
    }
  }
  sync_folder(session);
}

void write_mark(StoredManifest& stored, bool optimizing, const fs::path& session) {
  stored.optimizing = optimizing;
  stored.finished = !optimizing;
  write_whole_file(session / manifest_file_name, manifest_text(stored));
  sync_folder(session);
}

void copy_bytes(const fs::path& from, const fs::path& to) {
  std::ifstream in(from, std::ios::binary);
  OutputFile out(to);
  std::string bytes(std::size_t{1} << 20U, '\0');
  while (in.read(bytes.data(), static_cast<std::streamsize>(bytes.size())) || in.gcount() > 0) {
    out.write({bytes.data(), static_cast<std::size_t>(in.gcount())});
  }
  if (!in.eof()) throw input_error(from, std::string("cannot be read; ") + damaged_session_cure);
  out.close();
}

void copy_measured(const SessionEvidence& session, bool packed, const fs::path& folder) {
  copy_bytes(session.path / scans_file_name, folder / scans_file_name);
  copy_bytes(session.path / local_maps_file_name, folder / local_maps_file_name);
  for (const LocalMap& local_map : session.local_maps) {
    copy_bytes(local_map_file(session.path, local_map.id), local_map_file(folder, local_map.id));
  }
  if (packed) copy_bytes(session.path / pack_file_name, folder / pack_file_name);
}

}  // namespace

void update_session(const SessionEvidence& session, const SessionUpdate& update) {
  require_complete(session, update);
  const FolderLock lock(session.path);
  lock.require();
  StoredManifest stored = read_manifest(session.path);
  const StagingFolder staging(session.path / staging_folder_name);
  write_derived(staging.path(), session, update);
  sync_folder(staging.path());
  write_mark(stored, true, session.path);
  put_in_place(staging.path(), session.path);
  stored.manifest.program_version = version();
  write_mark(stored, false, session.path);
}

void copy_session(const SessionEvidence& session,
                  const SessionUpdate& update,
                  const fs::path& output,
                  bool overwrite) {
  require_complete(session, update);
  const fs::path path = folder_path(output);
  require_writable_target(path, overwrite);
  const fs::path partial = aside(path);
  FolderLock(partial).require();
  const StagingFolder staging(partial);
  const FolderLock lock(partial);
  const FolderLock source_lock(session.path);
  lock.require();
  source_lock.require();
  StoredManifest stored = read_manifest(session.path);
  stored.manifest.program_version = version();
  stored.finished = false;
  stored.optimizing = false;
  write_manifest(stored, partial);
  copy_measured(session, stored.manifest.pack.has_value(), partial);
  write_derived(partial, session, update);
  stored.finished = true;
  write_manifest(stored, partial);
  sync_folder(partial / local_maps_folder_name);
  sync_folder(partial);
  publish_folder(partial, path, overwrite);
}

}  // namespace kissmap
