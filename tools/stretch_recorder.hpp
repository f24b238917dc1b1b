// SPDX-License-Identifier: MIT
#pragma once

#include <filesystem>
#include <vector>

#include "kissmap/formats/surfel_spool.hpp"
#include "kissmap/loop_closing/stretch.hpp"
#include "kissmap/loop_closing/surface_links.hpp"

namespace kissmap {

/// Keeps the stretches of a run until their surfaces are linked: places and links of scans in
/// memory, surfels on the disk. Not thread safe.
class StretchRecorder {
 public:
  StretchRecorder(const std::filesystem::path& folder, double min_range, double max_range)
      : builder_(min_range, max_range), spool_(folder) {}

  void add(const Scan& scan, const MappedScan& mapped) { keep(builder_.add(scan, mapped)); }
  void finish() { keep(builder_.finish()); }

  /// See link_surfaces().
  void link(const TrajectoryByLinks& trajectory, ThreadPool& pool) const {
    link_surfaces(
        places_, [this](std::size_t i) { return spool_.read(i); }, scan_links_, trajectory, pool);
  }

 private:
  void keep(const std::optional<Stretch>& stretch) {
    if (!stretch) return;
    places_.push_back(stretch->place);
    spool_.add(stretch->surfels);
    scan_links_.insert(scan_links_.end(), stretch->scan_links.begin(), stretch->scan_links.end());
  }

  StretchBuilder builder_;
  SurfelSpool spool_;
  std::vector<StretchPlace> places_;
  std::vector<SurfaceLink> scan_links_;
};

}  // namespace kissmap
