// SPDX-License-Identifier: MIT
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "formats/files/output_file.hpp"
#include "kissmap/formats/grid_files.hpp"

namespace kissmap {

/// What write_grid() writes: image, then YAML. Throws Error(output) for a map without cells.
std::vector<WholeFile> grid_files(const GridMap& map,
                                  GridMode mode,
                                  const std::filesystem::path& stem,
                                  const std::vector<std::string>& comments);

}  // namespace kissmap
