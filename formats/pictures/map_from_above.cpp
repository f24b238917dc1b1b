// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cmath>
#include <iterator>
#include <string>

#include "formats/pictures/canvas.hpp"
#include "formats/pictures/height_colour.hpp"
#include "formats/pictures/map_raster.hpp"
#include "formats/session/correction_tables.hpp"
#include "formats/session/session_tables.hpp"
#include "kissmap/error.hpp"
#include "kissmap/formats/pictures.hpp"
#include "kissmap/formats/session.hpp"

namespace kissmap {
namespace {

constexpr int smallest_max_pixels = 64;
constexpr int largest_max_pixels = 16384;  // 1.6 GB while drawing

const Colour background(0.04F, 0.05F, 0.09F);
const Colour trajectory_colour(1.00F, 0.27F, 0.60F);
const Colour start_colour(0.20F, 0.90F, 0.35F);
const Colour end_colour(0.95F, 0.16F, 0.13F);
const Colour accepted_colour(0.35F, 1.00F, 0.45F);
const Colour refused_colour(0.80F, 0.22F, 0.18F);
const Colour ink(0.95F, 0.95F, 0.97F);

// Density above which a pixel is at full brightness: all but the densest 2 % of what is seen.
float full_density(const std::vector<float>& density) {
  std::vector<float> seen;
  std::ranges::copy_if(density, std::back_inserter(seen), [](float d) { return d > 0.0F; });
  if (seen.empty()) return 1.0F;
  const auto nth =
      seen.begin() + static_cast<std::ptrdiff_t>(0.98 * static_cast<double>(seen.size() - 1));
  std::ranges::nth_element(seen, nth);
  return *nth;
}

void paint_map(Canvas& canvas, const MapView& view, const MapRaster& raster) {
  constexpr float faint = 0.3F;  // brightness of the thinnest surface
  constexpr float contrast = 8.0F;
  const float full = full_density(raster.density);
  const auto range = static_cast<float>(view.high - view.low);
  for (int y = 0; y < view.height; ++y) {
    for (int x = 0; x < view.width; ++x) {
      const auto at = static_cast<std::size_t>(y) * static_cast<std::size_t>(view.width) +
                      static_cast<std::size_t>(x);
      const float density = raster.density[at] / full;
      if (density <= 0.0F) continue;
      // All height colours are about equally light, so light is free to tell the density.
      const float light = std::min(std::log1p(contrast * density) / std::log1p(contrast), 1.0F);
      const float height = (raster.height[at] - static_cast<float>(view.low)) / range;
      canvas.blend(x,
                   y,
                   (faint + (1.0F - faint) * light) * height_colour(height),
                   std::min(1.0F, 20.0F * density));
    }
  }
}

void paint_trajectory(Canvas& canvas,
                      const MapView& view,
                      const std::vector<Eigen::Vector3d>& trajectory) {
  if (trajectory.empty()) return;
  std::vector<Eigen::Vector2f> line;
  line.reserve(trajectory.size());
  for (const Eigen::Vector3d& position : trajectory) {
    line.push_back(view.pixel_from_map(position.head<2>()));
  }
  const float half_width =
      std::max(1.0F, static_cast<float>(std::max(view.width, view.height)) / 900.0F);
  canvas.draw_line(line, half_width + 1.0F, background);
  canvas.draw_line(line, half_width, trajectory_colour);
  const auto paint_marker = [&](const Eigen::Vector2f& at, float radius, const Colour& colour) {
    canvas.fill_disc(at, radius * half_width, background);
    canvas.fill_disc(at, (radius - 0.7F) * half_width, ink);
    canvas.fill_disc(at, (radius - 1.6F) * half_width, colour);
  };
  // The start is larger, so that it still shows where the end lies on it.
  paint_marker(line.front(), 8.0F, start_colour);
  paint_marker(line.back(), 6.0F, end_colour);
}

// Lines between the keyposes of pairs that were taken for one place.
void paint_closures(Canvas& canvas,
                    const MapView& view,
                    const std::vector<LocalMap>& local_maps,
                    const std::vector<Closure>& closures) {
  const float half_width =
      std::max(0.7F, static_cast<float>(std::max(view.width, view.height)) / 1600.0F);
  for (const bool accepted : {false, true}) {  // accepted ones on top
    for (const Closure& closure : closures) {
      if ((closure.verdict == ClosureVerdict::accepted) != accepted) continue;
      const auto pixel = [&](std::uint32_t id) {
        return view.pixel_from_map(local_maps[id].map_from_local_map.translation.head<2>());
      };
      canvas.draw_line({pixel(closure.query_id), pixel(closure.reference_id)},
                       accepted ? half_width : 0.5F * half_width,
                       accepted ? accepted_colour : refused_colour);
    }
  }
}

// The largest of 1, 2, 5, 10, 20, ... (or 0.1, 0.2, ...) that is not above `length`.
double round_length(double length) {
  const double decade = std::pow(10.0, std::floor(std::log10(length)));
  for (const double digit : {5.0, 2.0}) {
    if (digit * decade <= length) return digit * decade;
  }
  return decade;
}

std::string length_text(double metres) {
  if (metres >= 1000.0) return std::to_string(std::lround(metres / 1000.0)) + " km";
  if (metres >= 1.0) return std::to_string(std::lround(metres)) + " m";
  return "0." + std::to_string(std::lround(metres * 10.0)) + " m";
}

void paint_scale_bar(Canvas& canvas, double pixel_size) {
  const double length = std::max(round_length(0.22 * canvas.width() * pixel_size), 0.1);
  const int longer = std::max(canvas.width(), canvas.height());
  const int unit = std::max(1, longer / 400);
  const int left = std::max(2, longer / 50);
  const int right = left + static_cast<int>(std::lround(length / pixel_size));
  const int bottom = canvas.height() - 1 - std::max(2, longer / 60);
  canvas.fill_rectangle(left, bottom - unit, right, bottom, ink);
  canvas.fill_rectangle(left, bottom - 3 * unit, left + unit - 1, bottom, ink);
  canvas.fill_rectangle(right - unit + 1, bottom - 3 * unit, right, bottom, ink);
  const std::string text = length_text(length);
  const int text_left = std::max(left, (left + right - text_width(text, unit)) / 2);
  canvas.draw_text(text_left, bottom - 8 * unit, unit, text, ink);
}

}  // namespace

Picture draw_map_from_above(const std::filesystem::path& session_folder, int max_pixels) {
  MapLayout layout;
  layout.local_maps = read_local_maps(session_folder);
  for_each_scan(
      session_folder, layout.local_maps, UnclosedScans::pass_over, [&](const SessionScan& scan) {
        layout.trajectory.push_back(scan.mapped.map_from_lidar.translation);
      });
  layout.closures = read_closures(session_folder, layout.local_maps.size());
  return draw_map_from_above(session_folder, layout, max_pixels);
}

Picture draw_map_from_above(const std::filesystem::path& session_folder,
                            const MapLayout& layout,
                            int max_pixels) {
  if (max_pixels < smallest_max_pixels || max_pixels > largest_max_pixels) {
    throw usage_error("the longer side of a picture needs " + std::to_string(smallest_max_pixels) +
                      " to " + std::to_string(largest_max_pixels) + " pixels");
  }
  const MapView view =
      choose_view(session_folder, layout.local_maps, layout.trajectory, max_pixels);
  Canvas canvas(view.width, view.height, background);
  paint_map(canvas, view, draw_surfels(session_folder, layout.local_maps, view));
  paint_trajectory(canvas, view, layout.trajectory);
  paint_closures(canvas, view, layout.local_maps, layout.closures);
  paint_scale_bar(canvas, view.pixel_size);
  return canvas.picture();
}

}  // namespace kissmap
