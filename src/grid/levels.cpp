// SPDX-License-Identifier: MIT
#include "kissmap/grid/levels.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numeric>
#include <optional>
#include <unordered_map>

#include "kissmap/cloud/voxel.hpp"

namespace kissmap {
namespace {

constexpr double spacing = 0.5;          // m between the poses that are compared
constexpr double over_each_other = 4.0;  // m aside, at most
constexpr double least_storey = 1.6;     // m
constexpr double steepest = 0.3;         // slope of one floor
constexpr double same_floor = 10.0;      // m aside, at most

double aside(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  return (a - b).head<2>().norm();
}

bool is_over_or_under(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  const double distance = aside(a, b);
  return distance < over_each_other && std::abs(a.z() - b.z()) > least_storey + steepest * distance;
}

/// Poses by where they are in the plane.
class Places {
 public:
  explicit Places(double reach) : per_metre_(static_cast<float>(1.0 / reach)) {}

  void add(const Eigen::Vector3d& place, std::size_t idx) {
    cells_[key(place, 0, 0)].push_back(idx);
  }

  /// Calls with each pose within the reach, and some farther.
  template <typename Call>
  void near(const Eigen::Vector3d& place, const Call& call) const {
    for (int x = -1; x <= 1; ++x) {
      for (int y = -1; y <= 1; ++y) {
        const auto cell = cells_.find(key(place, x, y));
        if (cell == cells_.end()) continue;
        for (const std::size_t idx : cell->second) call(idx);
      }
    }
  }

 private:
  VoxelKey key(const Eigen::Vector3d& place, int x, int y) const {
    const Voxel voxel = voxel_of(place.cast<float>(), per_metre_);
    return voxel_key({voxel.x + x, voxel.y + y, 0});
  }

  float per_metre_;
  std::unordered_map<VoxelKey, std::vector<std::size_t>> cells_;
};

std::vector<std::size_t> spaced(const SensorPath& path) {
  std::vector<std::size_t> kept;
  for (std::size_t i = 0; i < path.size(); ++i) {
    if (kept.empty() || (path[i] - path[kept.back()]).norm() >= spacing) kept.push_back(i);
  }
  return kept;
}

/// On the way from `earlier` to `later`, where it has come near the later one's height: on the ramp
/// or the stairs, not on the storey before.
std::size_t cut_between(const SensorPath& way, std::size_t earlier, std::size_t later) {
  std::size_t cut = later;
  while (cut > earlier + 1 && std::abs(way[cut - 1].z() - way[later].z()) < 0.5 * least_storey) {
    --cut;
  }
  return cut;
}

/// First poses of the stretches that are nowhere over themselves.
std::vector<std::size_t> stretches(const SensorPath& way) {
  std::vector<std::size_t> firsts = {0};
  Places places(over_each_other);
  for (std::size_t later = 0; later < way.size(); ++later) {
    std::optional<std::size_t> earlier;
    places.near(way[later], [&](std::size_t idx) {
      if (idx < firsts.back() || !is_over_or_under(way[idx], way[later])) return;
      if (!earlier || idx > *earlier) earlier = idx;
    });
    if (earlier) firsts.push_back(cut_between(way, *earlier, later));
    places.add(way[later], later);
  }
  return firsts;
}

struct Level {
  Places places{same_floor};
  double height_sum = 0.0;
  std::size_t poses = 0;
};

class Levels {
 public:
  explicit Levels(const SensorPath& way) : way_(way) {}

  /// The level of way[begin..end), a new one if it lies on none of those known.
  std::size_t add(std::size_t begin, std::size_t end) {
    std::size_t best = levels_.size();
    double best_off = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < levels_.size(); ++i) {
      const std::optional<double> off = distance(levels_[i], begin, end);
      if (!off || *off >= best_off) continue;
      best = i;
      best_off = *off;
    }
    if (best == levels_.size()) levels_.emplace_back();
    for (std::size_t k = begin; k < end; ++k) {
      levels_[best].places.add(way_[k], k);
      levels_[best].height_sum += way_[k].z();
    }
    levels_[best].poses += end - begin;
    return best;
  }

  /// Places of the levels in the order of their heights.
  std::vector<std::uint32_t> ranks() const {
    std::vector<std::size_t> order(levels_.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::ranges::stable_sort(order, {}, [this](std::size_t i) {
      return levels_[i].height_sum / static_cast<double>(levels_[i].poses);
    });
    std::vector<std::uint32_t> ranks(levels_.size());
    for (std::uint32_t rank = 0; rank < order.size(); ++rank) ranks[order[rank]] = rank;
    return ranks;
  }

 private:
  /// How far from the level's floor the stretch lies, in height; none if it lies over the level
  /// somewhere, or nowhere near.
  std::optional<double> distance(const Level& level, std::size_t begin, std::size_t end) const {
    std::optional<double> least;
    bool over = false;
    for (std::size_t k = begin; k < end && !over; ++k) {
      level.places.near(way_[k], [&](std::size_t idx) {
        over |= is_over_or_under(way_[k], way_[idx]);
        const double off = std::abs(way_[k].z() - way_[idx].z());
        const bool same = off < 0.5 * least_storey + steepest * aside(way_[k], way_[idx]);
        if (same && (!least || off < *least)) least = off;
      });
    }
    return over ? std::nullopt : least;
  }

  const SensorPath& way_;
  std::vector<Level> levels_;
};

}  // namespace

std::vector<std::uint32_t> levels_of(const SensorPath& path) {
  const std::vector<std::size_t> kept = spaced(path);
  if (kept.empty()) return {};
  SensorPath way;
  for (const std::size_t idx : kept) way.push_back(path[idx]);
  std::vector<std::size_t> firsts = stretches(way);
  firsts.push_back(way.size());
  Levels levels(way);
  std::vector<std::size_t> level_of_kept;
  for (std::size_t i = 0; i + 1 < firsts.size(); ++i) {
    level_of_kept.resize(firsts[i + 1], levels.add(firsts[i], firsts[i + 1]));
  }
  const std::vector<std::uint32_t> ranks = levels.ranks();
  std::vector<std::uint32_t> result(path.size());
  std::size_t k = 0;
  for (std::size_t i = 0; i < path.size(); ++i) {
    if (k + 1 < kept.size() && kept[k + 1] <= i) ++k;
    result[i] = ranks[level_of_kept[k]];
  }
  return result;
}

}  // namespace kissmap
