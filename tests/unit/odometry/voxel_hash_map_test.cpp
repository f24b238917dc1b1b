// SPDX-License-Identifier: MIT
#include "kissmap/odometry/voxel_hash_map.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <tuple>

#include "support/random_clouds.hpp"

namespace kissmap {
namespace {

/// The same promises, kept in the simplest possible way.
class BruteForceMap {
 public:
  BruteForceMap(double voxel_size, std::size_t max_points)
      : size_(voxel_size), max_points_(max_points) {}

  void add(const std::vector<Eigen::Vector3f>& points) {
    const double spacing = size_ / std::sqrt(static_cast<double>(max_points_));
    for (const Eigen::Vector3f& p : points) {
      auto& voxel = voxels_[index(p)];
      const bool crowded = std::ranges::any_of(
          voxel, [&](const Eigen::Vector3f& other) { return (other - p).norm() < spacing; });
      if (voxel.size() < max_points_ && !crowded) voxel.push_back(p);
    }
  }

  void remove_farther_than(double distance, const Eigen::Vector3d& center) {
    std::erase_if(voxels_, [&](const auto& item) {
      const auto& [x, y, z] = item.first;
      return (Eigen::Vector3d(x + 0.5, y + 0.5, z + 0.5) * size_ - center).norm() > distance;
    });
  }

  /// Distances to all points of the 27 voxels around a query, ascending.
  std::vector<float> distances(const Eigen::Vector3f& query) const {
    std::vector<float> all;
    const auto [cx, cy, cz] = index(query);
    for (const auto& [key, points] : voxels_) {
      const auto& [x, y, z] = key;
      if (std::max({std::abs(x - cx), std::abs(y - cy), std::abs(z - cz)}) > 1) continue;
      for (const Eigen::Vector3f& p : points) all.push_back((p - query).norm());
    }
    std::ranges::sort(all);
    return all;
  }

  std::vector<Eigen::Vector3f> sorted_points() const {
    std::vector<Eigen::Vector3f> all;
    for (const auto& item : voxels_) all.insert(all.end(), item.second.begin(), item.second.end());
    return sorted(std::move(all));
  }

  static std::vector<Eigen::Vector3f> sorted(std::vector<Eigen::Vector3f> points) {
    std::ranges::sort(points, [](const Eigen::Vector3f& a, const Eigen::Vector3f& b) {
      return std::lexicographical_compare(a.begin(), a.end(), b.begin(), b.end());
    });
    return points;
  }

 private:
  using Index = std::tuple<int, int, int>;
  Index index(const Eigen::Vector3f& p) const {
    const auto axis = [this](float v) { return static_cast<int>(std::floor(v / size_)); };
    return {axis(p.x()), axis(p.y()), axis(p.z())};
  }

  double size_;
  std::size_t max_points_;
  std::map<Index, std::vector<Eigen::Vector3f>> voxels_;
};

TEST(VoxelHashMap, HoldsTheSamePointsAsBruteForceThroughAddsAndRemovals) {
  std::mt19937 random(21);
  VoxelHashMap map(1.0, 20);
  BruteForceMap oracle(1.0, 20);
  for (int round = 0; round < 12; ++round) {
    const Eigen::Vector3d center(3.0 * round, -2.0 * round, 0.5 * round);
    auto points = uniform_cloud(random, 20'000, 12.0F);
    for (Eigen::Vector3f& p : points) p += center.cast<float>();
    map.add(points);
    oracle.add(points);
    map.remove_farther_than(11.0, center);
    oracle.remove_farther_than(11.0, center);
    ASSERT_EQ(BruteForceMap::sorted(map.points()), oracle.sorted_points()) << "round " << round;
  }
}

TEST(VoxelHashMap, FindsWhatBruteForceFinds) {
  std::mt19937 random(22);
  VoxelHashMap map(1.0, 20);
  BruteForceMap oracle(1.0, 20);
  const auto points = uniform_cloud(random, 3000, 8.0F);
  map.add(points);
  oracle.add(points);
  for (const float radius : {0.2F, 0.7F, 6.0F}) {
    for (const Eigen::Vector3f& query : uniform_cloud(random, 2000, 9.0F)) {
      const auto neighbor = map.nearest(query, radius);
      const auto distances = oracle.distances(query);
      const bool exists = !distances.empty() && distances[0] < radius;
      ASSERT_EQ(neighbor.found, exists);
      if (exists) {
        ASSERT_FLOAT_EQ(neighbor.distance, distances[0]);
        ASSERT_FLOAT_EQ((neighbor.point - query).norm(), distances[0]);
      }
      // The promise behind skipped searches: nothing else is nearer than next_distance.
      const std::size_t others = exists ? 1 : 0;
      if (distances.size() > others) {
        ASSERT_LE(neighbor.next_distance, distances[others] * 1.00001F);
      }
      if (!exists) {
        ASSERT_GE(neighbor.next_distance, radius * 0.99999F);
      }
    }
  }
}

TEST(VoxelHashMap, AnEmptyMapFindsNothing) {
  const VoxelHashMap map(1.0, 20);
  EXPECT_TRUE(map.empty());
  EXPECT_FALSE(map.nearest(Eigen::Vector3f::Zero(), 100.0F).found);
}

TEST(VoxelHashMap, TakesNoMemoryInTheSteadyState) {
  std::mt19937 random(23);
  VoxelHashMap map(1.0, 20);
  const auto cloud = uniform_cloud(random, 30'000, 20.0F);
  std::size_t settled = 0;
  for (int step = 0; step < 200; ++step) {
    const Eigen::Vector3f shift(static_cast<float>(step), 0.0F, 0.0F);
    std::vector<Eigen::Vector3f> points = cloud;
    for (Eigen::Vector3f& p : points) p += shift;
    map.add(points);
    map.remove_farther_than(20.0, shift.cast<double>());
    if (step == 20) settled = map.memory_bytes();
  }
  EXPECT_EQ(map.memory_bytes(), settled);
}

TEST(VoxelHashMap, ClearedMapIsLikeNew) {
  std::mt19937 random(24);
  const auto first = uniform_cloud(random, 5000, 10.0F);
  const auto second = uniform_cloud(random, 5000, 10.0F);
  VoxelHashMap reused(0.5, 20);
  reused.add(first);
  reused.clear();
  reused.add(second);
  VoxelHashMap fresh(0.5, 20);
  fresh.add(second);
  EXPECT_EQ(reused.points(), fresh.points());
}

}  // namespace
}  // namespace kissmap
