// SPDX-License-Identifier: MIT
#pragma once

#include <string>

#include "commands.hpp"
#include "kissmap/formats/cloud_export.hpp"
#include "kissmap/formats/grid_export.hpp"
#include "kissmap/formats/voxel_export.hpp"

namespace kissmap {

/// What a command asks for, completed by the configuration of the session. Throws Error(usage).
CloudExportOptions cloud_options(const ExportCloudCommand& command, const Session& session);
GridExportOptions grid_options(const ExportGridCommand& command, const Session& session);
VoxelExportOptions voxel_options(const ExportVoxelsCommand& command, const Session& session);

/// "480 x 300 cells of 0.05 m, 512.3 m2 free, ..."
std::string describe(const ExportedGrid& grid);

/// "12,345 occupied, 67,890 free, of 0.05 m"
std::string describe(const VoxelExportSummary& summary);

}  // namespace kissmap
