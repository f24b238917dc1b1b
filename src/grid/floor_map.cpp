// SPDX-License-Identifier: MIT
#include "kissmap/grid/floor_map.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "grid/floor_growth.hpp"
#include "grid/height_field.hpp"

namespace kissmap {

FloorMap::FloorMap(
    Eigen::Vector2d corner, double cell_size, int width, int height, std::vector<float> z)
    : corner_(std::move(corner)),
      cell_size_(cell_size),
      width_(width),
      height_(height),
      z_(std::move(z)) {
  if (z_.empty()) return;
  const auto [low, high] = std::ranges::minmax(z_);
  lowest_ = static_cast<double>(low);
  highest_ = static_cast<double>(high);
}

double FloorMap::height(double x, double y) const {
  if (z_.empty()) return 0.0;
  const double u = std::clamp((x - corner_.x()) / cell_size_ - 0.5, 0.0, width_ - 1.0);
  const double v = std::clamp((y - corner_.y()) / cell_size_ - 0.5, 0.0, height_ - 1.0);
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

FloorMap floor_under(const SensorPath& path,
                     std::span<const FloorSample> samples,
                     double cell_size,
                     double sensor_height) {
  HeightField field = grow_floor(path, samples, cell_size, sensor_height);
  if (field.known() == 0) return {};
  smooth(field);
  fill(field);
  return {field.corner(), cell_size, field.width, field.height, std::move(field.z)};
}

}  // namespace kissmap
