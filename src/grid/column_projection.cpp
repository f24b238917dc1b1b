// SPDX-License-Identifier: MIT
#include "grid/column_projection.hpp"

#include <algorithm>
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

bool meets(const OccupancyBlock& block, const Eigen::AlignedBox2d& area, double resolution) {
  const Eigen::Vector2d low = Eigen::Vector2d(block.first.x, block.first.y) * resolution;
  return area.intersects({low, low + Eigen::Vector2d::Constant(side * resolution)});
}

Area area_of(const OccupancyMap& voxels, const Eigen::AlignedBox2d& limit) {
  Area area;
  voxels.for_each_block([&](const OccupancyBlock& block) {
    if (!meets(block, limit, voxels.geometry().voxel_size.x())) return;
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
      is_free_[i] = static_cast<double>(probability_[i]) < std::min(threshold, 0.5);
      is_occupied_[i] = static_cast<double>(probability_[i]) > threshold;
    }
    lowest_ = steps.min;
  }
  void count(LogOdds value, bool swept, ColumnCounts& column) const {
    if (value == unknown_log_odds) return;
    if (swept && is_occupied_[static_cast<std::size_t>(value + 128)]) value = lowest_;
    const auto i = static_cast<std::size_t>(value + 128);
    ++column.seen;
    column.free += is_free_[i] ? 1 : 0;
    column.highest = std::max(column.highest, probability_[i]);
  }

 private:
  std::array<float, 256> probability_{};
  std::array<bool, 256> is_free_{};
  std::array<bool, 256> is_occupied_{};
  LogOdds lowest_ = 0;
};

class Columns {
 public:
  Columns(const OccupancyMap& voxels, const ColumnRule& rule, const SweptCells& swept, GridMap& map)
      : geometry_(voxels.geometry()),
        beliefs_(voxels.steps(), rule.threshold),
        swept_(swept),
        map_(map),
        counts_(static_cast<std::size_t>(map.width) * static_cast<std::size_t>(map.height)) {}

  void add(const OccupancyBlock& block, const Area& area) {
    const SweptCells::BlockHeights* heights = swept_.in_block(block.first.x, block.first.y);
    for (std::int32_t y = 0; y < side; ++y) {
      ColumnCounts* row =
          &counts_[map_.index(block.first.x - area.low_x, block.first.y - area.low_y + y)];
      for (std::int32_t z = 0; z < side; ++z) {
        const auto values = block.values.subspan(static_cast<std::size_t>(z * side + y) * side);
        const double middle =
            geometry_.origin.z() + (block.first.z + z + 0.5) * geometry_.voxel_size.z();
        for (std::size_t x = 0; x < side; ++x) {
          const bool swept =
              heights != nullptr &&
              middle < static_cast<double>((*heights)[static_cast<std::size_t>(side * y) + x]);
          beliefs_.count(values[x], swept, row[x]);
        }
      }
    }
  }

  void judge(const ColumnRule& rule) {
    const std::int32_t layers = geometry_.layers->last - geometry_.layers->first + 1;
    map_.cells.reserve(counts_.size());
    for (const ColumnCounts& column : counts_) {
      map_.cells.push_back(judge_column(column, layers, rule));
    }
  }

 private:
  const OccupancyGeometry& geometry_;
  Beliefs beliefs_;
  const SweptCells& swept_;
  GridMap& map_;
  std::vector<ColumnCounts> counts_;
};

}  // namespace

GridMap project_columns(const OccupancyMap& voxels,
                        const ColumnRule& rule,
                        const SweptCells& swept,
                        const Eigen::AlignedBox2d& area) {
  const OccupancyGeometry& geometry = voxels.geometry();
  if (!geometry.layers) throw Error(Fault::internal, "a voxel map without layers has no columns");
  GridMap map;
  map.resolution = geometry.voxel_size.x();
  const Area blocks = area_of(voxels, area);
  if (blocks.high_x <= blocks.low_x) return map;
  map.corner = Eigen::Vector2d(blocks.low_x, blocks.low_y) * map.resolution;
  map.width = blocks.high_x - blocks.low_x;
  map.height = blocks.high_y - blocks.low_y;
  Columns columns(voxels, rule, swept, map);
  voxels.for_each_block([&](const OccupancyBlock& block) {
    if (meets(block, area, map.resolution)) columns.add(block, blocks);
  });
  columns.judge(rule);
  return map;
}

}  // namespace kissmap
