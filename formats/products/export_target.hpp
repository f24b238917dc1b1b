// SPDX-License-Identifier: MIT
#pragma once

#include "kissmap/formats/cloud_export.hpp"

namespace kissmap {

/// Throws Error(usage) for options that are out of range, exclude each other or do not go with the
/// name of the output.
void require_options(const std::filesystem::path& output, const CloudExportOptions& options);

/// Throws Error(output) where the output could not be put in place: asked before hours of work.
void require_target(const std::filesystem::path& output, const CloudExportOptions& options);

/// The same for a single file.
void require_file_target(const std::filesystem::path& output, bool overwrite);

}  // namespace kissmap
