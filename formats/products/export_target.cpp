// SPDX-License-Identifier: MIT
#include "formats/products/export_target.hpp"

#include <unistd.h>

#include <cmath>
#include <string>
#include <system_error>

#include "formats/products/tile_folder.hpp"
#include "kissmap/error.hpp"

namespace kissmap {

namespace fs = std::filesystem;

void require_options(const fs::path& output, const CloudExportOptions& options) {
  require_valid(options.crop);
  if (!(options.voxel_size >= 0.0) || !std::isfinite(options.voxel_size)) {
    throw usage_error("--voxel-size: is a length in metres, or 0 for every point");
  }
  const bool thinned = options.voxel_size > 0.0;
  const char* wants_voxels = " wants a thinned cloud: give a --voxel-size above 0";
  if (options.fields.normals && !thinned) throw usage_error(std::string("normals") + wants_voxels);
  if (options.remove_outliers && !thinned) {
    throw usage_error(std::string("--remove-outliers") + wants_voxels);
  }
  if (options.compress && options.tile_size == 0 && cloud_format(output) != CloudFormat::pcd) {
    throw usage_error("--compress: is for .pcd files");
  }
  if (options.tile_size < 0) throw usage_error("--tiles: is a length in whole metres");
  if (options.tile_size > 0) {
    if (!thinned) throw usage_error(std::string("--tiles") + wants_voxels);
    if (cloud_format(output)) {
      throw usage_error(output.string() + ": --tiles writes a folder of .pcd files; give its name");
    }
  } else if (!cloud_format(output)) {
    throw usage_error(output.string() +
                      ": a cloud is written to .pcd, .ply or .las, or with --tiles to a folder");
  }
}

namespace {

void require_folder_of(const fs::path& output) {
  std::error_code code;
  const fs::path folder = output.parent_path().empty() ? "." : output.parent_path();
  if (!fs::is_directory(folder, code)) throw output_error(folder, "is no folder; create it first");
  if (::access(folder.c_str(), W_OK) != 0) {
    throw output_error(folder, "cannot be written to; choose a folder you may write to");
  }
}

}  // namespace

void require_target(const fs::path& output, const CloudExportOptions& options) {
  if (options.tile_size == 0) return require_file_target(output, options.overwrite);
  require_folder_of(output);
  require_tile_target(output, options.overwrite);
}

void require_file_target(const fs::path& output, bool overwrite) {
  require_folder_of(output);
  std::error_code code;
  const fs::file_type type = fs::symlink_status(output, code).type();
  if (type == fs::file_type::not_found) return;
  if (type != fs::file_type::regular) {
    throw output_error(output, "is not a file and is not overwritten; choose another name");
  }
  if (!overwrite) {
    throw output_error(output, "exists already; choose another name, or --overwrite it");
  }
}

}  // namespace kissmap
