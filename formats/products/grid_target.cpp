// SPDX-License-Identifier: MIT
#include "formats/products/grid_target.hpp"

#include <string>
#include <system_error>

#include "formats/products/export_target.hpp"
#include "kissmap/error.hpp"

namespace kissmap {

namespace fs = std::filesystem;

fs::path with_suffix(fs::path stem, const std::string& suffix) {
  stem += suffix;
  return stem;
}

std::vector<fs::path> level_stems(const fs::path& stem, std::uint32_t levels) {
  if (levels == 1) return {stem};
  std::vector<fs::path> stems;
  for (std::uint32_t level = 0; level < levels; ++level) {
    stems.push_back(with_suffix(stem, "_level" + std::to_string(level)));
  }
  return stems;
}

fs::path contents_path(const fs::path& stem) {
  return with_suffix(stem, "_levels.yaml");
}

fs::path look_path(const fs::path& stem) {
  return with_suffix(stem, "_look.png");
}

void require_grid_target(const fs::path& stem,
                         std::uint32_t levels,
                         const GridExportOptions& options) {
  std::error_code code;
  const fs::file_type type = fs::status(stem, code).type();
  // A folder or a file of the bare name is nobody's map: the maps have endings.
  if (type == fs::file_type::block || type == fs::file_type::character ||
      type == fs::file_type::fifo || type == fs::file_type::socket) {
    throw output_error(stem, "is a device and no name for a map; choose another name");
  }
  for (const fs::path& each : level_stems(stem, levels)) {
    for (const fs::path& file : grid_file_paths(each, options.mode)) {
      require_file_target(file, options.overwrite);
    }
    require_file_target(look_path(each), options.overwrite);
  }
  if (levels > 1) require_file_target(contents_path(stem), options.overwrite);
}

}  // namespace kissmap
