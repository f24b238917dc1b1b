// SPDX-License-Identifier: MIT
#include "kissmap/grid/floor_map.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "grid/floor_growth.hpp"
#include "grid/height_field.hpp"

namespace kissmap {

namespace {

constexpr double seen_reach = 2.0;  // m around what was seen

/// Bytes that are 1 where a height is known at most `reach` cells away along each axis.
std::vector<std::uint8_t> known_within(const HeightField& field, int reach) {
  std::vector<std::uint8_t> known(field.z.size());
  std::ranges::transform(
      field.z, known.begin(), [](float z) { return static_cast<std::uint8_t>(!std::isnan(z)); });
  const auto spread = [&](int count, int length, int step_between, int step_along) {
    for (int line = 0; line < count; ++line) {
      std::uint8_t* const first = known.data() + static_cast<std::ptrdiff_t>(line) * step_between;
      const auto at = [&](int i) -> std::uint8_t& {
        return first[static_cast<std::ptrdiff_t>(i) * step_along];
      };
      std::vector<std::uint8_t> before(static_cast<std::size_t>(length));
      for (int i = 0; i < length; ++i) before[static_cast<std::size_t>(i)] = at(i);
      int last = -reach - 1;  // known one that was passed
      int next = 0;
      for (int i = 0; i < length; ++i) {
        for (; next < length && next <= i + reach; ++next) {
          if (before[static_cast<std::size_t>(next)] != 0) last = next;
        }
        at(i) = static_cast<std::uint8_t>(last >= i - reach);
      }
    }
  };
  spread(field.height, field.width, field.width, 1);
  spread(field.width, field.height, 1, field.width);
  return known;
}

}  // namespace

FloorMap::FloorMap(Eigen::Vector2d corner,
                   double cell_size,
                   int width,
                   int height,
                   std::vector<float> z,
                   std::vector<std::uint8_t> seen)
    : corner_(std::move(corner)),
      cell_size_(cell_size),
      cells_per_metre_(1.0 / cell_size),
      width_(width),
      height_(height),
      z_(std::move(z)),
      is_seen_(std::move(seen)) {
  if (z_.empty()) return;
  const auto [low, high] = std::ranges::minmax(z_);
  lowest_ = static_cast<double>(low);
  highest_ = static_cast<double>(high);
}

double FloorMap::height(double x, double y) const {
  if (z_.empty()) return 0.0;
  const double u = std::clamp((x - corner_.x()) * cells_per_metre_ - 0.5, 0.0, width_ - 1.0);
  const double v = std::clamp((y - corner_.y()) * cells_per_metre_ - 0.5, 0.0, height_ - 1.0);
  const int i = std::min(static_cast<int>(u), std::max(0, width_ - 2));
  const int j = std::min(static_cast<int>(v), std::max(0, height_ - 2));
  const int right = width_ > 1 ? 1 : 0;
  const int up = height_ > 1 ? width_ : 0;
  const float* cell = z_.data() + static_cast<std::ptrdiff_t>(j) * width_ + i;
  const double s = u - i;
  const double t = v - j;
  return (1.0 - t) *
             ((1.0 - s) * static_cast<double>(cell[0]) + s * static_cast<double>(cell[right])) +
         t * ((1.0 - s) * static_cast<double>(cell[up]) +
              s * static_cast<double>(cell[up + right]));
}

bool FloorMap::is_seen(double x, double y) const {
  if (is_seen_.empty()) return true;
  const double u = (x - corner_.x()) / cell_size_;
  const double v = (y - corner_.y()) / cell_size_;
  if (!(u >= 0.0 && u < width_ && v >= 0.0 && v < height_)) return false;
  const auto row = static_cast<std::size_t>(v) * static_cast<std::size_t>(width_);
  return is_seen_[row + static_cast<std::size_t>(u)] != 0;
}

FloorMap floor_under(const SensorPath& path,
                     std::span<const FloorSample> samples,
                     double cell_size,
                     double sensor_height) {
  HeightField field = grow_floor(path, samples, cell_size, sensor_height);
  if (field.known() == 0) return {};
  std::vector<std::uint8_t> seen =
      known_within(field, static_cast<int>(std::lround(seen_reach / cell_size)));
  smooth(field);
  fill(field);
  return {
      field.corner(), cell_size, field.width, field.height, std::move(field.z), std::move(seen)};
}

}  // namespace kissmap
