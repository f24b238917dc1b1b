// SPDX-License-Identifier: MIT
#pragma once

#include <filesystem>
#include <vector>

#include "kissmap/formats/grid_export.hpp"

namespace kissmap {

/// STEM with a suffix, whatever dots it has.
std::filesystem::path with_suffix(std::filesystem::path stem, const std::string& suffix);

/// Names of the maps of so many storeys: STEM, or STEM_level0 and so on.
std::vector<std::filesystem::path> level_stems(const std::filesystem::path& stem,
                                               std::uint32_t levels);

/// The list of several storeys.
std::filesystem::path contents_path(const std::filesystem::path& stem);

/// The picture for people.
std::filesystem::path look_path(const std::filesystem::path& stem);

/// Throws Error(output) where one of the files could not be put in place, or is there without
/// `overwrite`: asked before hours of work.
void require_grid_target(const std::filesystem::path& stem,
                         std::uint32_t levels,
                         const GridExportOptions& options);

}  // namespace kissmap
