// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cmath>
#include <string>

#include "formats/pictures/canvas.hpp"
#include "kissmap/formats/grid_files.hpp"

namespace kissmap {
namespace {

constexpr int smallest_side = 900;  // pixels; smaller maps are enlarged
constexpr int border = 16;          // pixels

const Colour paper(0.78F, 0.80F, 0.83F);
const Colour free_colour(1.00F, 1.00F, 1.00F);
const Colour occupied_colour(0.07F, 0.08F, 0.12F);
const Colour trajectory_colour(0.20F, 0.45F, 0.95F);
const Colour start_colour(0.10F, 0.65F, 0.25F);
const Colour end_colour(0.90F, 0.15F, 0.12F);
const Colour ink(0.10F, 0.11F, 0.15F);

struct View {
  int cells_per_pixel = 1;
  int pixels_per_cell = 1;
  int width = 0;  ///< pixels, without the border
  int height = 0;

  View(const GridMap& map, int max_pixels) {
    const int longest = std::max({map.width, map.height, 1});
    while (longest / cells_per_pixel > max_pixels) cells_per_pixel *= 2;
    if (cells_per_pixel == 1) pixels_per_cell = std::max(1, smallest_side / longest);
    width = (map.width + cells_per_pixel - 1) / cells_per_pixel * pixels_per_cell;
    height = (map.height + cells_per_pixel - 1) / cells_per_pixel * pixels_per_cell;
  }

  double pixels_per_metre(const GridMap& map) const {
    return pixels_per_cell / (map.resolution * cells_per_pixel);
  }
  Eigen::Vector2f pixel_of(const GridMap& map, const Eigen::Vector2d& place) const {
    const Eigen::Vector2d off = (place - map.corner) * pixels_per_metre(map);
    return {static_cast<float>(border + off.x() - 0.5),
            static_cast<float>(border + height - off.y() - 0.5)};
  }
};

/// Of the cells of one pixel, an occupied one is shown before a free one.
CellState state_of(const GridMap& map, const View& view, int column, int row) {
  CellState state = CellState::unknown;
  for (int y = row * view.cells_per_pixel; y < (row + 1) * view.cells_per_pixel; ++y) {
    for (int x = column * view.cells_per_pixel; x < (column + 1) * view.cells_per_pixel; ++x) {
      if (map.holds(x, y)) state = std::max(state, map.at(x, y).state);
    }
  }
  return state;
}

void paint_cells(Canvas& canvas, const GridMap& map, const View& view) {
  for (int y = 0; y < view.height; ++y) {
    const int row = (view.height - 1 - y) / view.pixels_per_cell;
    for (int x = 0; x < view.width; ++x) {
      const CellState state = state_of(map, view, x / view.pixels_per_cell, row);
      if (state == CellState::unknown) continue;
      canvas.blend(
          x + border, y + border, state == CellState::occupied ? occupied_colour : free_colour);
    }
  }
}

void paint_scale(Canvas& canvas, double pixels_per_metre) {
  double metres = 1.0;
  for (const double longer : {2.0, 5.0, 10.0, 20.0, 50.0, 100.0, 200.0, 500.0, 1000.0}) {
    if (longer * pixels_per_metre < 0.3 * canvas.width()) metres = longer;
  }
  const int length = static_cast<int>(std::lround(metres * pixels_per_metre));
  const int bottom = canvas.height() - 6;
  canvas.fill_rectangle(border, bottom - 3, border + length, bottom, ink);
  canvas.draw_text(
      border + length + 8, bottom - 9, 2, std::to_string(static_cast<int>(metres)) + " m", ink);
}

}  // namespace

Picture draw_grid(const GridMap& map, const std::vector<PlanPath>& stretches, int max_pixels) {
  const View view(map, max_pixels);
  Canvas canvas(view.width + 2 * border, view.height + 3 * border, paper);
  paint_cells(canvas, map, view);
  std::vector<Eigen::Vector2f> ends;
  for (const PlanPath& stretch : stretches) {
    if (stretch.empty()) continue;
    std::vector<Eigen::Vector2f> line;
    line.reserve(stretch.size());
    for (const Eigen::Vector2d& place : stretch) line.push_back(view.pixel_of(map, place));
    canvas.draw_line(line, 1.2F, trajectory_colour);
    ends.push_back(line.front());
    ends.push_back(line.back());
  }
  if (!ends.empty()) {
    canvas.fill_disc(ends.front(), 5.0F, start_colour);
    canvas.fill_disc(ends.back(), 5.0F, end_colour);
  }
  paint_scale(canvas, view.pixels_per_metre(map));
  return canvas.picture();
}

}  // namespace kissmap
