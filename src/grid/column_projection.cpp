// SPDX-License-Identifier: MIT
#include "grid/column_projection.hpp"

#include <array>
#include <limits>

#include "kissmap/error.hpp"

namespace kissmap {
namespace {

constexpr std::int32_t side = occupancy_block_side;

struct Area {
  std::int32_t low_x = std::numeric_limits<std::int32_t>::max();
  std::int32_t low_y = std::numeric_limits<std::int32_t>::max();
  std::int32_t high_x = std::numeric_limits<std::int32_t>::min();
  std::int32_t high_y = std::numeric_limits<std::int32_t>::min();
};

Area area_of(const OccupancyMap& voxels) {
  Area area;
  voxels.for_each_block([&area](const OccupancyBlock& block) {
    area.low_x = std::min(area.low_x, block.first.x);
    area.low_y = std::min(area.low_y, block.first.y);
    area.high_x = std::max(area.high_x, block.first.x + side);
    area.high_y = std::max(area.high_y, block.first.y + side);
  });
  return area;
}

/// What a rule makes of each belief, looked up instead of computed for each voxel.
class Beliefs {
 public:
  Beliefs(const LogOddsSteps& steps, double threshold) {
    for (std::size_t i = 0; i < 256; ++i) {
      const auto value = static_cast<LogOdds>(static_cast<int>(i) - 128);
      probability_[i] = static_cast<float>(steps.probability(value));
      is_free_[i] = static_cast<double>(probability_[i]) < threshold;
    }
  }
  void count(LogOdds value, ColumnCounts& column) const {
    if (value == unknown_log_odds) return;
    const auto i = static_cast<std::size_t>(value + 128);
    ++column.seen;
    column.free += is_free_[i] ? 1 : 0;
    column.highest = std::max(column.highest, probability_[i]);
  }

 private:
  std::array<float, 256> probability_{};
  std::array<bool, 256> is_free_{};
};

}  // namespace

GridMap project_columns(const OccupancyMap& voxels, const ColumnRule& rule) {
  const OccupancyGeometry& geometry = voxels.geometry();
  if (!geometry.layers) throw Error(Fault::internal, "a voxel map without layers has no columns");
  const std::int32_t layers = geometry.layers->last - geometry.layers->first + 1;
  GridMap map;
  map.resolution = geometry.voxel_size.x();
  if (voxels.block_count() == 0) return map;
  const Area area = area_of(voxels);
  map.corner = Eigen::Vector2d(area.low_x, area.low_y) * map.resolution;
  map.width = area.high_x - area.low_x;
  map.height = area.high_y - area.low_y;
  const auto cells = static_cast<std::size_t>(map.width) * static_cast<std::size_t>(map.height);
  std::vector<ColumnCounts> columns(cells);
  const Beliefs beliefs(voxels.steps(), rule.threshold);
  voxels.for_each_block([&](const OccupancyBlock& block) {
    for (std::int32_t y = 0; y < side; ++y) {
      ColumnCounts* row =
          &columns[map.index(block.first.x - area.low_x, block.first.y - area.low_y + y)];
      for (std::int32_t z = 0; z < side; ++z) {
        const auto values = block.values.subspan(static_cast<std::size_t>(z * side + y) * side);
        for (std::size_t x = 0; x < side; ++x) beliefs.count(values[x], row[x]);
      }
    }
  });
  map.cells.reserve(cells);
  for (const ColumnCounts& column : columns) {
    map.cells.push_back(judge_column(column, layers, rule));
  }
  return map;
}

}  // namespace kissmap
