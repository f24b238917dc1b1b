// SPDX-License-Identifier: MIT
#pragma once

#include <filesystem>
#include <optional>
#include <vector>

#include "formats/files/table.hpp"
#include "kissmap/loop_closing/loop_correction.hpp"
#include "kissmap/mapping/local_map.hpp"

namespace kissmap {

// keyposes.csv, poses.csv, closures.csv, neighbors.csv, surfaces.csv and pose_graph.g2o of a
// session; columns in FORMAT.md. They are there if the session was corrected. Reading throws
// Error(input) naming file, line, column and cure, writing Error(output).

/// Writes all of them. `stamps_ns` by local map: of its first scan's pose.
void write_correction(const std::filesystem::path& session,
                      const LoopCorrection& correction,
                      const std::vector<std::uint64_t>& log_indices,
                      const std::vector<std::int64_t>& stamps_ns);

/// Replaces keyposes by the corrected ones, if there are any. A table with too few or too many rows
/// is an error.
void correct_keyposes(const std::filesystem::path& session, std::vector<LocalMap>& local_maps);

/// Reads poses.csv beside scans.csv.
class CorrectedPoses {
 public:
  explicit CorrectedPoses(const std::filesystem::path& session);
  /// The pose of the next scan, which must have this index.
  Rigid3 next(std::uint64_t log_index);

 private:
  std::filesystem::path path_;
  TableReader table_;
};
/// Nothing if the session was not corrected.
std::optional<CorrectedPoses> open_corrected_poses(const std::filesystem::path& session);

/// Candidates for closures without their information; none if the session was not corrected.
std::vector<Closure> read_closures(const std::filesystem::path& session, std::size_t local_maps);

/// Closures that nobody added by hand.
std::uint64_t count_measured(const std::vector<Closure>& closures);

/// None if the session was not corrected.
std::vector<NeighborLink> read_neighbors(const std::filesystem::path& session,
                                         std::size_t local_maps);

/// None if the session was not corrected, or before there were any.
std::vector<SurfaceLink> read_surfaces(const std::filesystem::path& session, std::size_t scans);

}  // namespace kissmap
