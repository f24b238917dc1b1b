// SPDX-License-Identifier: MIT
#include "formats/pictures/canvas.hpp"

#include <algorithm>
#include <cmath>

#include "formats/pictures/glyphs.hpp"

namespace kissmap {
namespace {

// With the gap before the next character.
int advance(const Glyph& glyph) {
  return static_cast<int>(glyph.rows[0].size()) + 1;
}

float distance_to_segment(const Eigen::Vector2f& point,
                          const Eigen::Vector2f& from,
                          const Eigen::Vector2f& to) {
  const Eigen::Vector2f along = to - from;
  const float length2 = along.squaredNorm();
  const float t =
      length2 > 0.0F ? std::clamp((point - from).dot(along) / length2, 0.0F, 1.0F) : 0.0F;
  return (point - from - t * along).norm();
}

// How much of a pixel a shape covers whose edge is `inside` pixels beyond the pixel's centre.
float edge_coverage(float inside) {
  return std::clamp(inside + 0.5F, 0.0F, 1.0F);
}

struct PixelRange {
  int first;
  int last;
};

PixelRange clip(float low, float high, int size) {
  const auto limit = static_cast<float>(size);
  return {static_cast<int>(std::floor(std::clamp(low, 0.0F, limit))),
          static_cast<int>(std::ceil(std::clamp(high, -1.0F, limit - 1.0F)))};
}

}  // namespace

Canvas::Canvas(int width, int height, const Colour& background) {
  picture_.width = width;
  picture_.height = height;
  picture_.rgb.resize(3 * static_cast<std::size_t>(width) * static_cast<std::size_t>(height));
  fill_rectangle(0, 0, width - 1, height - 1, background);
}

void Canvas::blend(int x, int y, const Colour& colour, float coverage) {
  if (x < 0 || y < 0 || x >= width() || y >= height()) return;
  const std::size_t at = 3 * (static_cast<std::size_t>(y) * static_cast<std::size_t>(width()) +
                              static_cast<std::size_t>(x));
  for (std::size_t i = 0; i < 3; ++i) {
    const float before = picture_.rgb[at + i];
    const float wanted = 255.0F * std::clamp(colour[static_cast<Eigen::Index>(i)], 0.0F, 1.0F);
    picture_.rgb[at + i] =
        static_cast<std::uint8_t>(std::lround(before + coverage * (wanted - before)));
  }
}

void Canvas::fill_rectangle(int left, int top, int right, int bottom, const Colour& colour) {
  for (int y = top; y <= bottom; ++y) {
    for (int x = left; x <= right; ++x) blend(x, y, colour);
  }
}

void Canvas::fill_disc(const Eigen::Vector2f& centre, float radius, const Colour& colour) {
  draw_line({centre}, radius, colour);
}

void Canvas::draw_line(const std::vector<Eigen::Vector2f>& points,
                       float half_width,
                       const Colour& colour) {
  // Collected before it is painted: overlapping edges of segments would add up to a rough line.
  std::vector<float> coverage(picture_.rgb.size() / 3, 0.0F);
  const auto columns = static_cast<std::size_t>(width());
  const float reach = half_width + 1.0F;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Eigen::Vector2f& to = points[i];
    const Eigen::Vector2f& from = points[i == 0 ? 0 : i - 1];
    const auto [left, right] =
        clip(std::min(from.x(), to.x()) - reach, std::max(from.x(), to.x()) + reach, width());
    const auto [top, bottom] =
        clip(std::min(from.y(), to.y()) - reach, std::max(from.y(), to.y()) + reach, height());
    for (int y = top; y <= bottom; ++y) {
      for (int x = left; x <= right; ++x) {
        const Eigen::Vector2f pixel(static_cast<float>(x), static_cast<float>(y));
        const float covered = edge_coverage(half_width - distance_to_segment(pixel, from, to));
        float& place =
            coverage[static_cast<std::size_t>(y) * columns + static_cast<std::size_t>(x)];
        place = std::max(place, covered);
      }
    }
  }
  for (int y = 0; y < height(); ++y) {
    for (int x = 0; x < width(); ++x) {
      const float covered =
          coverage[static_cast<std::size_t>(y) * columns + static_cast<std::size_t>(x)];
      if (covered > 0.0F) blend(x, y, colour, covered);
    }
  }
}

void Canvas::draw_text(int left, int top, int unit, std::string_view text, const Colour& colour) {
  for (const char character : text) {
    const Glyph& glyph = find_glyph(character);
    for (std::size_t row = 0; row < glyph_height; ++row) {
      for (std::size_t column = 0; column < glyph.rows[row].size(); ++column) {
        if (glyph.rows[row][column] != '#') continue;
        const int x = left + static_cast<int>(column) * unit;
        const int y = top + static_cast<int>(row) * unit;
        fill_rectangle(x, y, x + unit - 1, y + unit - 1, colour);
      }
    }
    left += advance(glyph) * unit;
  }
}

int text_width(std::string_view text, int unit) {
  int dots = 0;
  for (const char character : text) dots += advance(find_glyph(character));
  return std::max(0, dots - 1) * unit;
}

}  // namespace kissmap
