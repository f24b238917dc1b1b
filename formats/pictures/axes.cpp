// SPDX-License-Identifier: MIT
#include "formats/pictures/axes.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace kissmap {
namespace {

const Colour grid_colour(0.88F, 0.89F, 0.91F);
const Colour ink(0.15F, 0.16F, 0.20F);
constexpr int text_unit = 2;
constexpr int text_height = 5 * text_unit;

// A lone value, or values alike but for rounding, get a metre around them.
Interval with_margin(Interval interval) {
  const double size = std::max(interval.size(), 1e-9 * std::abs(interval.high));
  const double margin = size > 0.0 ? 0.05 * size : 0.5;
  return {interval.low - margin, interval.high + margin};
}

void widen(Interval& interval, double size) {
  const double more = 0.5 * (size - interval.size());
  if (more > 0.0) interval = {interval.low - more, interval.high + more};
}

void draw_frame(Canvas& canvas, const Frame& f) {
  canvas.fill_rectangle(f.left, f.top, f.right, f.top, ink);
  canvas.fill_rectangle(f.left, f.bottom, f.right, f.bottom, ink);
  canvas.fill_rectangle(f.left, f.top, f.left, f.bottom, ink);
  canvas.fill_rectangle(f.right, f.top, f.right, f.bottom, ink);
}

void draw_x_tick(Canvas& canvas, const Axes& axes, const Tick& tick) {
  const int x = static_cast<int>(std::lround(axes.pixel_from(tick.value, axes.y.low).x()));
  canvas.fill_rectangle(x, axes.frame.top, x, axes.frame.bottom, grid_colour);
  const int left = x - text_width(tick.text, text_unit) / 2;
  canvas.draw_text(left, axes.frame.bottom + text_height, text_unit, tick.text, ink);
}

void draw_y_tick(Canvas& canvas, const Axes& axes, const Tick& tick) {
  const int y = static_cast<int>(std::lround(axes.pixel_from(axes.x.low, tick.value).y()));
  canvas.fill_rectangle(axes.frame.left, y, axes.frame.right, y, grid_colour);
  const int left = axes.frame.left - 8 - text_width(tick.text, text_unit);
  canvas.draw_text(left, y - text_height / 2, text_unit, tick.text, ink);
}

}  // namespace

void Interval::include(double value) {
  low = std::min(low, value);
  high = std::max(high, value);
}

Eigen::Vector2f Axes::pixel_from(double x_value, double y_value) const {
  const double right = (x_value - x.low) / x.size();
  const double up = (y_value - y.low) / y.size();
  return {static_cast<float>(frame.left + right * (frame.right - frame.left)),
          static_cast<float>(frame.bottom - up * (frame.bottom - frame.top))};
}

Axes fit_axes(const Frame& frame, const Interval& x, const Interval& y, bool equal) {
  Axes axes{frame, with_margin(x), with_margin(y)};
  if (!equal) return axes;
  const double width = frame.right - frame.left;
  const double height = frame.bottom - frame.top;
  const double per_pixel = std::max(axes.x.size() / width, axes.y.size() / height);
  widen(axes.x, per_pixel * width);
  widen(axes.y, per_pixel * height);
  return axes;
}

std::vector<Tick> ticks(const Interval& interval, int count) {
  const double rough = interval.size() / count;
  if (!(rough > 0.0) || !std::isfinite(rough)) return {};
  const double decade = std::pow(10.0, std::floor(std::log10(rough)));
  double step = 10.0 * decade;
  for (const double digit : {5.0, 2.0, 1.0}) {
    if (digit * decade >= 0.999 * rough) step = digit * decade;
  }
  const int decimals = std::clamp(static_cast<int>(-std::floor(std::log10(step) + 1e-9)), 0, 9);
  std::vector<Tick> result;
  for (double i = std::ceil(interval.low / step); i * step <= interval.high; i += 1.0) {
    char text[64];
    // + 0.0 turns -0 to 0.
    std::snprintf(text, sizeof text, "%.*f", decimals, i * step + 0.0);
    result.push_back({i * step, text});
    if (result.size() > 100) break;  // numbers too large for their steps
  }
  return result;
}

void draw_axes(Canvas& canvas,
               const Axes& axes,
               const std::string& x_label,
               const std::string& y_label) {
  constexpr int ticks_wanted = 7;
  for (const Tick& tick : ticks(axes.x, ticks_wanted)) draw_x_tick(canvas, axes, tick);
  for (const Tick& tick : ticks(axes.y, ticks_wanted)) draw_y_tick(canvas, axes, tick);
  draw_frame(canvas, axes.frame);
  const Frame& f = axes.frame;
  const int x_left = (f.left + f.right - text_width(x_label, text_unit)) / 2;
  canvas.draw_text(x_left, f.bottom + 3 * text_height, text_unit, x_label, ink);
  canvas.draw_text(f.left, f.top - 2 * text_height, text_unit, y_label, ink);
}

}  // namespace kissmap
