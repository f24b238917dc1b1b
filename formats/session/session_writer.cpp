// SPDX-License-Identifier: MIT
#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <numeric>
#include <utility>

#include "formats/files/output_file.hpp"
#include "formats/session/correction_tables.hpp"
#include "formats/session/local_map_ply.hpp"
#include "formats/session/manifest_json.hpp"
#include "formats/session/session_folder.hpp"
#include "formats/session/session_tables.hpp"
#include "formats/trajectories/pose_lines.hpp"
#include "kissmap/error.hpp"
#include "kissmap/formats/g2o.hpp"
#include "kissmap/formats/session.hpp"
#include "kissmap/version.hpp"

namespace kissmap {
namespace {

// Held while a session is being written, so that a second run does not take the folder for stale.
class FolderLock {
 public:
  explicit FolderLock(const std::filesystem::path& folder)
      : descriptor_(::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC)) {}
  ~FolderLock() {
    if (descriptor_ >= 0) ::close(descriptor_);
  }
  FolderLock(const FolderLock&) = delete;
  FolderLock& operator=(const FolderLock&) = delete;

  bool take() const {
    return descriptor_ < 0 || ::flock(descriptor_, LOCK_EX | LOCK_NB) == 0 || errno != EWOULDBLOCK;
  }

 private:
  int descriptor_;
};

Error busy(const std::filesystem::path& partial) {
  return output_error(partial,
                      "is being written by another run; wait for it or choose another name");
}

std::filesystem::path prepare_partial(const std::filesystem::path& path, bool overwrite) {
  require_writable_target(path, overwrite);
  std::filesystem::path partial = aside(path);
  if (!FolderLock(partial).take()) throw busy(partial);
  create_partial_folder(partial);
  return partial;
}

// Streams the table back, so that a long log needs no memory here.
void write_trajectories(const std::filesystem::path& session) {
  OutputFile tum(session / tum_file_name);
  OutputFile kitti(session / kitti_file_name);
  tum.write(tum_header);
  const std::vector<LocalMap> local_maps = read_local_maps(session);
  for_each_scan(session, local_maps, UnclosedScans::refuse, [&](const SessionScan& scan) {
    tum.write(tum_line(scan.mapped.pose_stamp_ns, scan.mapped.map_from_lidar));
    kitti.write(kitti_line(scan.mapped.map_from_lidar));
  });
  tum.close();
  kitti.close();
}

}  // namespace

class SessionWriter::Impl {
 public:
  Impl(const std::filesystem::path& path, bool overwrite)
      : path_(folder_path(path)),
        overwrite_(overwrite),
        partial_(prepare_partial(path_, overwrite)),
        lock_(partial_),
        scans_(partial_ / scans_file_name),
        local_maps_(partial_ / local_maps_file_name) {
    if (!lock_.take()) throw busy(partial_);
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
    write_manifest({manifest, false, {}}, partial_);
  }

  void add_scan(const SessionScan& scan) {
    require_open();
    if (sizes_.scans > 0 && scan.log_index <= last_log_index_) {
      throw Error(Fault::internal, "scans of a session must come in the order of the log");
    }
    scans_.write(scan_row(scan));
    scans_.flush();
    log_indices_.push_back(scan.log_index);
    const std::size_t id = scan.mapped.local_map_id;
    // A local map that ended with its first scan leaves its stamp to the ones without.
    first_stamps_ns_.resize(std::max(first_stamps_ns_.size(), id + 1), scan.mapped.pose_stamp_ns);
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

  void correct(const SessionCorrection& correction) {
    require_open();
    if (correction.map_from_lidar.size() != sizes_.scans ||
        correction.map_from_local_map.size() != sizes_.local_maps) {
      throw Error(Fault::internal, "a correction must place every scan and every local map");
    }
    write_keyposes(partial_, correction.map_from_local_map);
    write_poses(partial_, log_indices_, correction.map_from_lidar);
    write_closures(partial_, correction.closures, first_stamps_ns_);
    GraphFile graph{correction.graph, {}, true, {}};
    graph.ids.resize(sizes_.local_maps);
    std::iota(graph.ids.begin(), graph.ids.end(), std::int64_t{0});
    write_g2o(graph, partial_ / graph_file_name, correction.edge_weights);
  }

  void finish(const SessionManifest& manifest) {
    require_open();
    require_complete(manifest);
    finished_ = true;
    scans_.close();
    local_maps_.close();
    write_trajectories(partial_);
    write_manifest({manifest, true, sizes_}, partial_);
    sync_folder(partial_ / local_maps_folder_name);
    sync_folder(partial_);
    publish_folder(partial_, path_, overwrite_);
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
  FolderLock lock_;
  OutputFile scans_;
  OutputFile local_maps_;
  TableSizes sizes_;
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

void SessionWriter::correct(const SessionCorrection& correction) {
  impl_->correct(correction);
}

const std::filesystem::path& SessionWriter::partial_path() const {
  return impl_->partial_path();
}

void SessionWriter::finish(const SessionManifest& manifest) {
  impl_->finish(manifest);
}

}  // namespace kissmap
