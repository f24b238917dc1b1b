// SPDX-License-Identifier: MIT
#pragma once

#include <string>
#include <vector>

#include "formats/pictures/canvas.hpp"

namespace kissmap {

struct Interval {
  double low = 0.0;
  double high = 0.0;

  double size() const { return high - low; }
  void include(double value);
};

/// A rectangle of a picture [pixels, y down].
struct Frame {
  int left = 0;
  int top = 0;
  int right = 0;
  int bottom = 0;
};

/// A diagram: the values `x` and `y` over a frame of pixels, y up.
struct Axes {
  Frame frame;
  Interval x;
  Interval y;

  Eigen::Vector2f pixel_from(double x_value, double y_value) const;
};

/// Axes that show both intervals with a margin. `equal`: one scale for both, the frame kept.
Axes fit_axes(const Frame& frame, const Interval& x, const Interval& y, bool equal);

/// Round numbers inside an interval, about `count` of them: a step of 1, 2 or 5 times a power of
/// ten. The shortest text that tells them apart belongs to each.
struct Tick {
  double value;
  std::string text;
};
std::vector<Tick> ticks(const Interval& interval, int count);

/// The frame, a grid with numbers, and the names of the axes.
void draw_axes(Canvas& canvas,
               const Axes& axes,
               const std::string& x_label,
               const std::string& y_label);

}  // namespace kissmap
