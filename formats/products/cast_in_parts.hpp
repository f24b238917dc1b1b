// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <vector>

#include "kissmap/formats/export_progress.hpp"
#include "kissmap/formats/session.hpp"
#include "kissmap/mapping/placed_scan.hpp"
#include "kissmap/occupancy/occupancy_map.hpp"

namespace kissmap {

struct CastOptions {
  double min_range = 0.0;           ///< m; nearer returns are left out
  double max_range = 100.0;         ///< m; farther ones, too
  std::filesystem::path moved_log;  ///< where the log is now, if it moved
  std::uint64_t max_memory = 0;     ///< bytes of all maps; one column of tiles may take more
  bool no_returns = false;          ///< whether rays without a return are cast, too
};

struct CastSummary {
  std::uint64_t passes = 0;       ///< over the log
  std::uint64_t peak_memory = 0;  ///< bytes of the maps, at most
  std::uint64_t no_returns = 0;   ///< rays without a return that the log tells, if they were cast
};

/// Gives each scan of a session to `add`, which casts its rays into `maps`, and calls `on_part`
/// when these hold all that was seen: once if that fits into memory, else as often as it takes, for
/// parts that share no column, each from a pass over the log. Together the parts are what one pass
/// would have given. All maps are cut along the same columns. Throws Error(input) as SessionReplay
/// does.
CastSummary cast_in_parts(const Session& session,
                          const CastOptions& options,
                          const std::vector<OccupancyMap*>& maps,
                          const ExportProgress& progress,
                          const std::function<void(const PlacedScan&)>& add,
                          const std::function<void()>& on_part);

}  // namespace kissmap
