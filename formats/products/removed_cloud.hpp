// SPDX-License-Identifier: MIT
#pragma once

#include <filesystem>
#include <memory>

#include "kissmap/formats/cloud_export.hpp"
#include "kissmap/occupancy/moved_returns.hpp"

namespace kissmap {

/// What of the scans of a session moved, from two passes over the log.
std::unique_ptr<MovedReturns> find_moved(const Session& session,
                                         const CloudExportOptions& options,
                                         ThreadPool& pool,
                                         const ExportProgress& progress);

/// Where the points go that are left out of `output`: map.pcd -> map_removed.pcd, of tiles in
/// folder -> folder_removed.pcd.
std::filesystem::path removed_path(const std::filesystem::path& output);

}  // namespace kissmap
