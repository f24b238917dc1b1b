// SPDX-License-Identifier: MIT
#pragma once

#include <functional>

#include "kissmap/formats/cloud_export.hpp"
#include "kissmap/mapping/placed_scan.hpp"

namespace kissmap {

/// Calls `take` for every point of a session that is within the ranges and the crop, in the order
/// of the log. Throws Error(input) for a scan without intensities where `fields` wants them.
void for_each_point(const Session& session,
                    const CloudExportOptions& options,
                    const CloudFields& fields,
                    const ExportProgress& progress,
                    const std::function<void(const MapPoint&)>& take);

/// Whether the first scan that has points has intensities, too.
bool has_intensities(const Session& session, const CloudExportOptions& options);

}  // namespace kissmap
