// SPDX-License-Identifier: MIT
#include "grid/swept_cells.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace kissmap {
namespace {

constexpr double longest_gap = 3.0;  // m between poses

// Blocks of the occupancy map begin at multiples of their side, below zero, too.
constexpr std::int32_t side = occupancy_block_side;
std::int32_t block_of(std::int32_t cell) {
  return (cell >= 0 ? cell : cell - side + 1) / side;
}

}  // namespace

void SweptCells::add(const SensorPath& stretch, const FloorMap& floor, double half_width) {
  if (!(half_width > 0.0)) return;
  for (std::size_t i = 0; i < stretch.size(); ++i) {
    add_disc(stretch[i], floor, half_width);
    if (i == 0) continue;
    const Eigen::Vector3d way = stretch[i] - stretch[i - 1];
    const double length = way.norm();
    if (length > longest_gap) continue;
    const int steps = static_cast<int>(std::ceil(length / (0.5 * half_width)));
    for (int k = 1; k < steps; ++k) add_disc(stretch[i - 1] + way * k / steps, floor, half_width);
  }
}

void SweptCells::add_disc(const Eigen::Vector3d& sensor, const FloorMap& floor, double half_width) {
  const auto height = static_cast<float>(sensor.z() - floor.height(sensor.x(), sensor.y()));
  const auto cell = [this](double v) {
    return static_cast<std::int32_t>(std::floor(v / resolution_));
  };
  for (std::int32_t y = cell(sensor.y() - half_width); y <= cell(sensor.y() + half_width); ++y) {
    for (std::int32_t x = cell(sensor.x() - half_width); x <= cell(sensor.x() + half_width); ++x) {
      const Eigen::Vector2d middle = resolution_ * Eigen::Vector2d(x + 0.5, y + 0.5);
      if ((middle - sensor.head<2>()).norm() > half_width) continue;
      auto [block, is_new] = blocks_.try_emplace(voxel_key({block_of(x), block_of(y), 0}));
      if (is_new) block->second.fill(-std::numeric_limits<float>::infinity());
      const std::int32_t i = x - side * block_of(x) + side * (y - side * block_of(y));
      float& highest = block->second[static_cast<std::size_t>(i)];
      highest = std::max(highest, height);
    }
  }
}

const SweptCells::BlockHeights* SweptCells::in_block(std::int32_t x, std::int32_t y) const {
  const auto found = blocks_.find(voxel_key({block_of(x), block_of(y), 0}));
  return found == blocks_.end() ? nullptr : &found->second;
}

}  // namespace kissmap
