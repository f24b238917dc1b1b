// SPDX-License-Identifier: MIT
#include <png.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <string>

#include "formats/grids/grid_bytes.hpp"
#include "kissmap/error.hpp"

namespace kissmap {
namespace {

constexpr char occupied_value = 0;
constexpr char free_value = static_cast<char>(254);
constexpr char unknown_value = static_cast<char>(205);

std::filesystem::path with_ending(const std::filesystem::path& stem, const char* ending) {
  std::filesystem::path path = stem;
  path += ending;
  return path;
}

std::string pgm_bytes(const GridMap& map) {
  std::string bytes =
      "P5\n" + std::to_string(map.width) + " " + std::to_string(map.height) + "\n255\n";
  bytes.reserve(bytes.size() + map.cells.size());
  for (int y = map.height - 1; y >= 0; --y) {
    for (int x = 0; x < map.width; ++x) {
      const CellState state = map.at(x, y).state;
      bytes += state == CellState::occupied ? occupied_value
               : state == CellState::free   ? free_value
                                            : unknown_value;
    }
  }
  return bytes;
}

std::string png_bytes(const GridMap& map) {
  std::string pixels;
  pixels.reserve(2 * map.cells.size());
  for (int y = map.height - 1; y >= 0; --y) {
    for (int x = 0; x < map.width; ++x) {
      const GridCell& cell = map.at(x, y);
      const float share = std::clamp(1.0F - cell.probability, 0.0F, 1.0F);
      const bool known = cell.state != CellState::unknown;
      // Readers of ROS 1 test the thresholds before the alpha: unknown is grey, too.
      pixels += static_cast<char>(known ? std::lround(255.0F * share) : 128);
      pixels += static_cast<char>(known ? 255 : 0);
    }
  }
  png_image image{};
  image.version = PNG_IMAGE_VERSION;
  image.width = static_cast<png_uint_32>(map.width);
  image.height = static_cast<png_uint_32>(map.height);
  image.format = PNG_FORMAT_GA;
  std::string bytes(PNG_IMAGE_PNG_SIZE_MAX(image), '\0');
  png_alloc_size_t size = bytes.size();
  if (png_image_write_to_memory(&image, bytes.data(), &size, 0, pixels.data(), 0, nullptr) == 0) {
    throw Error(Fault::internal, std::string("PNG: ") + image.message);
  }
  bytes.resize(size);
  return bytes;
}

std::string number(double value) {
  char text[32];
  std::snprintf(text, sizeof(text), "%.9g", value);
  return text;
}

std::string yaml_text(const GridMap& map,
                      GridMode mode,
                      const std::string& image,
                      const std::vector<std::string>& comments) {
  std::string yaml;
  for (const std::string& comment : comments) yaml += "# " + comment + "\n";
  yaml += "image: " + yaml_quoted(image) + "\n";
  yaml += "resolution: " + number(map.resolution) + "\n";
  yaml += "origin: [" + number(map.corner.x()) + ", " + number(map.corner.y()) + ", 0.0]\n";
  yaml += "negate: 0\noccupied_thresh: 0.65\nfree_thresh: 0.196\n";
  yaml += std::string("mode: ") + (mode == GridMode::scale ? "scale" : "trinary") + "\n";
  return yaml;
}

}  // namespace

std::string yaml_quoted(const std::string& text) {
  std::string result = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') result += '\\';
    if (static_cast<unsigned char>(c) < 0x20) {
      char code[8];
      std::snprintf(code, sizeof(code), "\\x%02x", static_cast<unsigned>(c));
      result += code;
    } else {
      result += c;
    }
  }
  return result + "\"";
}

std::vector<std::filesystem::path> grid_file_paths(const std::filesystem::path& stem,
                                                   GridMode mode) {
  return {with_ending(stem, mode == GridMode::scale ? ".png" : ".pgm"), with_ending(stem, ".yaml")};
}

std::vector<WholeFile> grid_files(const GridMap& map,
                                  GridMode mode,
                                  const std::filesystem::path& stem,
                                  const std::vector<std::string>& comments) {
  const std::vector<std::filesystem::path> paths = grid_file_paths(stem, mode);
  if (map.cells.empty()) {
    throw output_error(paths.back(), "a map without cells is not written: nothing was seen in it");
  }
  return {{paths.front(), mode == GridMode::scale ? png_bytes(map) : pgm_bytes(map)},
          {paths.back(), yaml_text(map, mode, paths.front().filename().string(), comments)}};
}

void write_grid(const GridMap& map,
                GridMode mode,
                const std::filesystem::path& stem,
                const std::vector<std::string>& comments) {
  write_whole_files(grid_files(map, mode, stem, comments));
}

}  // namespace kissmap
