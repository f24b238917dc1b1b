// SPDX-License-Identifier: MIT
#pragma once

#include <filesystem>

#include "kissmap/mapping/local_map.hpp"

namespace kissmap {

/// Writes surfels as binary PLY, aside and then renamed. Throws Error(output), and
/// Error(internal) if means and normals differ in number.
void write_surfels(const SurfelCloud& surfels, const std::filesystem::path& path);

/// Reads what write_surfels wrote: the size must fit and all numbers be finite.
/// Throws Error(input) naming file, place and cure.
SurfelCloud read_surfels(const std::filesystem::path& path);

}  // namespace kissmap
