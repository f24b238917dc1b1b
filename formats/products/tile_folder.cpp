// SPDX-License-Identifier: MIT
#include "formats/products/tile_folder.hpp"

#include <cmath>
#include <map>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

#include "formats/files/output_file.hpp"
#include "formats/products/offset_file.hpp"
#include "kissmap/error.hpp"

namespace kissmap {
namespace {

namespace fs = std::filesystem;

constexpr const char* metadata_name = "pointcloud_map_metadata.yaml";
constexpr const char* offset_name = "offset.txt";

using Corner = std::pair<std::int64_t, std::int64_t>;  // m
using Tiles = std::map<Corner, std::vector<std::uint64_t>>;

std::string tile_name(const Corner& corner) {
  return "tile_" + std::to_string(corner.first) + "_" + std::to_string(corner.second) + ".pcd";
}

// Those of ours, complete or stopped while they were written.
bool is_tile_file(const fs::directory_entry& entry) {
  std::string name = entry.path().filename().string();
  if (name.ends_with(".partial")) name.resize(name.size() - std::string(".partial").size());
  const bool is_tile = name.starts_with("tile_") && name.ends_with(".pcd") &&
                       name.find_first_not_of("-_0123456789", 5) == name.size() - 4;
  return entry.symlink_status().type() == fs::file_type::regular &&
         (is_tile || name == metadata_name || name == offset_name);
}

void require_only_tiles(const fs::path& folder) {
  std::error_code code;
  if (fs::symlink_status(folder, code).type() != fs::file_type::directory) {
    throw output_error(folder,
                       "is not a folder of tiles and is not overwritten; choose another name");
  }
  for (const fs::directory_entry& entry : fs::directory_iterator(folder)) {
    if (is_tile_file(entry)) continue;
    throw output_error(folder,
                       "holds " + entry.path().filename().string() +
                           ", which is no tile, and is not overwritten; choose another name");
  }
}

fs::path replaced(const fs::path& path) {
  return path.string() + ".replaced";
}

/// The folder the tiles are written to; gone unless it has been given its name.
class PartialFolder {
 public:
  explicit PartialFolder(fs::path path) : path_(std::move(path)) {
    std::error_code code;
    if (fs::exists(fs::symlink_status(path_, code))) {
      require_only_tiles(path_);
      fs::remove_all(path_);
    }
    if (!fs::create_directory(path_, code)) {
      throw output_error(path_, "cannot be created: " + code.message() + "; choose another place");
    }
  }
  ~PartialFolder() {
    std::error_code ignored;
    fs::remove_all(path_, ignored);
  }
  PartialFolder(const PartialFolder&) = delete;
  PartialFolder& operator=(const PartialFolder&) = delete;

  const fs::path& path() const { return path_; }

  void publish(const fs::path& name, bool overwrite) {
    sync_folder(path_);
    const bool replaces = overwrite && fs::exists(name);
    if (replaces) rename_path(name, replaced(name));
    rename_path(path_, name);
    sync_folder(name.parent_path());
    std::error_code ignored;
    if (replaces) fs::remove_all(replaced(name), ignored);
  }

 private:
  fs::path path_;
};

// By the coordinates as they are written, so that rounding moves no point out of its tile.
Corner corner_of(const CloudPoint& point, int tile_size, const Eigen::Vector3d& offset) {
  const Eigen::Vector3f written = (point.point.position - offset).cast<float>();
  const auto corner = [tile_size](float coordinate) {
    return tile_size *
           static_cast<std::int64_t>(std::floor(static_cast<double>(coordinate) / tile_size));
  };
  return {corner(written.x()), corner(written.y())};
}

Tiles sort_into_tiles(const TiledCloud& cloud, int tile_size, const Eigen::Vector3d& offset) {
  Tiles tiles;
  for (std::uint64_t i = 0; i < cloud.size; ++i) {
    tiles[corner_of(cloud.point(i), tile_size, offset)].push_back(i);
  }
  return tiles;
}

std::string metadata_of(const Tiles& tiles, int tile_size) {
  const std::string size = std::to_string(tile_size) + ".0\n";
  std::string text = "x_resolution: " + size + "y_resolution: " + size;
  for (const auto& [corner, points] : tiles) {
    text += tile_name(corner) + ": [" + std::to_string(corner.first) + ", " +
            std::to_string(corner.second) + "]\n";
  }
  return text;
}

}  // namespace

void require_tile_target(const fs::path& path, bool overwrite) {
  std::error_code code;
  if (fs::exists(fs::symlink_status(replaced(path), code))) {
    throw output_error(replaced(path),
                       "is left from an interrupted overwrite; rename or remove it first");
  }
  if (!fs::exists(fs::symlink_status(path, code))) return;
  if (!overwrite)
    throw output_error(path, "exists already; choose another name, or --overwrite it");
  require_only_tiles(path);
}

std::uint64_t write_tile_folder(const fs::path& path,
                                const TiledCloud& cloud,
                                int tile_size,
                                const CloudWriterOptions& options,
                                bool overwrite) {
  PartialFolder folder(aside(path));
  const Tiles tiles = sort_into_tiles(cloud, tile_size, options.offset);
  for (const auto& [corner, points] : tiles) {
    const auto writer = open_cloud_writer(folder.path() / tile_name(corner), options);
    for (const std::uint64_t i : points) writer->add(cloud.point(i));
    writer->finish();
  }
  write_whole_file(folder.path() / metadata_name, metadata_of(tiles, tile_size));
  if (!options.offset.isZero(0.0)) {
    write_whole_file(folder.path() / offset_name, offset_text(options.offset));
  }
  folder.publish(path, overwrite);
  return tiles.size();
}

}  // namespace kissmap
