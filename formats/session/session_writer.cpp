// SPDX-License-Identifier: MIT
#include <algorithm>
#include <optional>
#include <utility>

#include "formats/files/output_file.hpp"
#include "formats/session/correction_tables.hpp"
#include "formats/session/local_map_ply.hpp"
#include "formats/session/manifest_json.hpp"
#include "formats/session/session_folder.hpp"
#include "formats/session/session_tables.hpp"
#include "formats/session/trajectory_files.hpp"
#include "kissmap/error.hpp"
#include "kissmap/formats/session.hpp"
#include "kissmap/version.hpp"

namespace kissmap {
namespace {

std::filesystem::path prepare_partial(const std::filesystem::path& path, bool overwrite) {
  require_writable_target(path, overwrite);
  std::filesystem::path partial = aside(path);
  FolderLock(partial).require();
  create_partial_folder(partial);
  return partial;
}

// Streams the table back, so that a long log needs no memory here.
void write_trajectories(const std::filesystem::path& session) {
  TrajectoryFiles files(session);
  const std::vector<LocalMap> local_maps = read_local_maps(session);
  for_each_scan(session, local_maps, UnclosedScans::refuse, [&](const SessionScan& scan) {
    files.add(scan.mapped.pose_stamp_ns, scan.mapped.map_from_lidar);
  });
  files.close();
}

}  // namespace

class SessionWriter::Impl {
 public:
  Impl(const std::filesystem::path& path, bool overwrite)
      : path_(folder_path(path)),
        overwrite_(overwrite),
        partial_(prepare_partial(path_, overwrite)),
        lock_(std::in_place, partial_),
        scans_(partial_ / scans_file_name),
        local_maps_(partial_ / local_maps_file_name) {
    lock_->require();
    scans_.write(scans_header() + '\n');
    scans_.flush();
    local_maps_.write(local_maps_header() + '\n');
    local_maps_.flush();
    SessionManifest unknown;
    unknown.program_version = version();
    describe(unknown);
  }

  void describe(const SessionManifest& manifest) {
    require_open();
    write_manifest({manifest, false, false, {}}, partial_);
  }

  void add_scan(const SessionScan& scan) {
    require_open();
    if (sizes_.scans > 0 && scan.log_index <= last_log_index_) {
      throw Error(Fault::internal, "scans of a session must come in the order of the log");
    }
    scans_.write(scan_row(scan));
    scans_.flush();
    log_indices_.push_back(scan.log_index);
    note_first_stamp(scan.mapped, first_stamps_ns_);
    last_log_index_ = scan.log_index;
    last_local_map_id_ = std::max(last_local_map_id_, scan.mapped.local_map_id);
    ++sizes_.scans;
  }

  // The row follows the surfels: where there is a row, the local map is whole.
  void add_local_map(const LocalMap& local_map) {
    require_open();
    if (local_map.id != sizes_.local_maps) {
      throw Error(Fault::internal, "local maps of a session must count from 0");
    }
    const std::string row = local_map_row(local_map);
    write_surfels(local_map.surfels, local_map_file(partial_, local_map.id));
    local_maps_.write(row);
    local_maps_.flush();
    ++sizes_.local_maps;
  }

  void correct(const LoopCorrection& correction) {
    require_open();
    if (correction.map_from_lidar.size() != sizes_.scans ||
        correction.map_from_local_map.size() != sizes_.local_maps) {
      throw Error(Fault::internal, "a correction must place every scan and every local map");
    }
    write_correction(partial_, correction, log_indices_, first_stamps_ns_);
    sizes_.closures = count_measured(correction.closures);
    sizes_.neighbors = correction.neighbors.size();
    sizes_.surfaces = correction.surfaces.size();
  }

  void finish(const SessionManifest& manifest) {
    require_open();
    require_complete(manifest);
    finished_ = true;
    scans_.close();
    local_maps_.close();
    write_trajectories(partial_);
    write_manifest({manifest, true, false, sizes_}, partial_);
    sync_folder(partial_ / local_maps_folder_name);
    sync_folder(partial_);
    publish_folder(partial_, path_, overwrite_);
    lock_.reset();
  }

  const std::filesystem::path& partial_path() const { return partial_; }

 private:
  void require_open() const {
    if (finished_) throw Error(Fault::internal, "the session was finished before");
  }

  void require_complete(const SessionManifest& manifest) const {
    if (manifest.counts.scans_used != sizes_.scans) {
      throw Error(Fault::internal, "scans_used is not the number of scans added to the session");
    }
    if (sizes_.scans > 0 && last_local_map_id_ >= sizes_.local_maps) {
      throw Error(Fault::internal, "the local map of the session's last scans was not added");
    }
  }

  std::filesystem::path path_;
  bool overwrite_;
  std::filesystem::path partial_;
  std::optional<FolderLock> lock_;  ///< until the session has its name
  OutputFile scans_;
  OutputFile local_maps_;
  TableSizes sizes_{0, 0, 0, 0, 0};
  std::vector<std::int64_t> first_stamps_ns_;  ///< of the local maps, for correct()
  std::vector<std::uint64_t> log_indices_;     ///< of the scans, for correct()
  std::uint64_t last_log_index_ = 0;
  std::uint32_t last_local_map_id_ = 0;
  bool finished_ = false;
};

SessionWriter::SessionWriter(const std::filesystem::path& path, bool overwrite)
    : impl_(std::make_unique<Impl>(path, overwrite)) {
}

SessionWriter::~SessionWriter() = default;

void SessionWriter::describe(const SessionManifest& manifest) {
  impl_->describe(manifest);
}

void SessionWriter::add_scan(const SessionScan& scan) {
  impl_->add_scan(scan);
}

void SessionWriter::add_local_map(const LocalMap& local_map) {
  impl_->add_local_map(local_map);
}

void SessionWriter::correct(const LoopCorrection& correction) {
  impl_->correct(correction);
}

const std::filesystem::path& SessionWriter::partial_path() const {
  return impl_->partial_path();
}

void SessionWriter::finish(const SessionManifest& manifest) {
  impl_->finish(manifest);
}

}  // namespace kissmap
