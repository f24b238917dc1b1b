// SPDX-License-Identifier: MIT
#pragma once

#include <Eigen/Core>
#include <array>
#include <string_view>
#include <vector>

#include "kissmap/formats/pictures.hpp"

namespace kissmap {

/// Red, green, blue, each 0..1.
using Colour = Eigen::Array3f;

/// A picture being drawn. Positions in pixels, x right, y down, pixel centres at whole numbers.
/// Whatever lies outside is cut off.
class Canvas {
 public:
  Canvas(int width, int height, const Colour& background);

  int width() const { return picture_.width; }
  int height() const { return picture_.height; }
  const Picture& picture() const { return picture_; }

  void blend(int x, int y, const Colour& colour, float coverage = 1.0F);
  void fill_rectangle(int left, int top, int right, int bottom, const Colour& colour);
  void fill_disc(const Eigen::Vector2f& centre, float radius, const Colour& colour);

  /// A line through all points with round joints, the same strength where it crosses itself.
  void draw_line(const std::vector<Eigen::Vector2f>& points,
                 float half_width,
                 const Colour& colour);

  /// Digits, letters (small ones as capitals but k and m), ' ' and .-_/()%:,+= ; `unit` pixels
  /// for each dot of a font 5 dots high.
  void draw_text(int left, int top, int unit, std::string_view text, const Colour& colour);

 private:
  Picture picture_;
};

/// Width of what draw_text draws [pixels].
int text_width(std::string_view text, int unit);

}  // namespace kissmap
