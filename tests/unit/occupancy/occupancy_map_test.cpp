// SPDX-License-Identifier: MIT
#include "kissmap/occupancy/occupancy_map.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <random>
#include <set>

#include "kissmap/error.hpp"
#include "unit/occupancy/ray_oracle.hpp"

namespace kissmap {
namespace {

constexpr float nan = std::numeric_limits<float>::quiet_NaN();
constexpr float infinity = std::numeric_limits<float>::infinity();

/// Rays from about one place to all sides; `count` of them, a tenth without a hit.
std::vector<TestRay> bundle(unsigned seed, std::size_t count, float reach) {
  std::mt19937 random(seed);
  std::normal_distribution<float> normal;
  std::uniform_real_distribution<float> unit(0.0F, 1.0F);
  std::vector<TestRay> rays;
  for (std::size_t i = 0; i < count; ++i) {
    const Eigen::Vector3f start(0.3F * unit(random), 0.3F * unit(random), 0.1F * unit(random));
    Eigen::Vector3f direction(normal(random), normal(random), 0.3F * normal(random));
    direction.normalize();
    const bool hit = unit(random) < 0.9F;
    rays.push_back({start, start + reach * unit(random) * direction, hit, 0.4F * unit(random)});
  }
  return rays;
}

std::map<Voxel, int> mapped(const std::vector<TestRay>& rays,
                            int threads,
                            const OccupancyOptions& options = {},
                            const OccupancyGeometry& geometry = {}) {
  OccupancyMap map(geometry, options);
  ThreadPool pool(threads);
  const TestScan scan(rays);
  map.add(scan.scan, pool);
  return content(map);
}

TEST(OccupancyMap, IsEmptyAtFirst) {
  OccupancyMap map({});
  ThreadPool pool(2);
  EXPECT_EQ(map.at({0, 0, 0}), unknown_log_odds);
  EXPECT_EQ(map.block_count(), 0U);
  EXPECT_EQ(map.add({}, pool).rays, 0U);
  EXPECT_TRUE(content(map).empty());
  EXPECT_FALSE(map.is_occupied({0, 0, 0}));
  EXPECT_FALSE(map.is_free({0, 0, 0}));
}

TEST(OccupancyMap, UpdatesEachVoxelOnceAScanAndHitsWin) {
  const auto rays = bundle(1, 3000, 6.0F);
  OccupancyMap map({});
  ThreadPool pool(1);
  const TestScan scan(rays);
  const OccupancyUpdate update = map.add(scan.scan, pool);
  std::set<Voxel> ends;
  for (const TestRay& ray : rays) {
    if (ray.hit) ends.insert(*voxel_at(map.geometry(), ray.end.cast<double>()));
  }
  std::size_t missed = 0;
  for (const auto& [voxel, value] : content(map)) {
    const bool hit = ends.contains(voxel);
    ASSERT_EQ(value, hit ? map.steps().hit : -map.steps().miss);
    if (hit) continue;
    ++missed;
    ASSERT_TRUE(std::ranges::any_of(rays, [&](const TestRay& ray) {
      return carves(map.geometry(), {0, 0, 0}, ray, voxel) != Crossing::no;
    }));
  }
  for (const Voxel& end : ends) ASSERT_TRUE(map.is_occupied(end));
  EXPECT_EQ(update.hit_voxels, ends.size());
  EXPECT_EQ(update.missed_voxels, missed);
}

TEST(OccupancyMap, LeavesNoCrossedVoxelOut) {
  const auto rays = bundle(2, 300, 4.0F);
  const auto voxels = mapped(rays, 1);
  for (int z = -20; z < 20; ++z) {
    for (int y = -22; y < 22; ++y) {
      for (int x = -22; x < 22; ++x) {
        const bool sure = std::ranges::any_of(rays, [&](const TestRay& ray) {
          return carves({}, {0, 0, 0}, ray, {x, y, z}) == Crossing::yes;
        });
        ASSERT_TRUE(!sure || voxels.contains({x, y, z})) << x << " " << y << " " << z;
      }
    }
  }
}

TEST(OccupancyMap, AddsAndClampsLogOdds) {
  OccupancyMap map({});
  ThreadPool pool(1);
  const LogOddsSteps steps = map.steps();
  const TestScan hit({{{0, 0, 0}, {1.1F, 0.1F, 0.1F}, true}});
  const TestScan through({{{0, 0, 0}, {2.1F, 0.15F, 0.15F}, true}});
  const Voxel voxel{5, 0, 0};
  std::mt19937 random(4);
  int expected = 0;
  std::set<int> seen;
  for (int i = 0; i < 400; ++i) {
    const bool is_hit = random() % 100 < (i < 200 ? 20U : 50U);
    map.add(is_hit ? hit.scan : through.scan, pool);
    expected = is_hit ? std::min(expected + steps.hit, int{steps.max})
                      : std::max(expected - steps.miss, int{steps.min});
    ASSERT_EQ(map.at(voxel), expected);
    seen.insert(expected);
    ASSERT_EQ(map.is_occupied(voxel), expected > 0);
    ASSERT_EQ(map.is_free(voxel), expected <= 0);
  }
  EXPECT_TRUE(seen.contains(steps.min));
  EXPECT_TRUE(seen.contains(steps.max));
}

TEST(OccupancyMap, IsTheSameForAnyNumberOfThreadsAndAnyScratch) {
  const auto rays = bundle(5, 20'000, 25.0F);
  const auto one = mapped(rays, 1);
  EXPECT_GT(one.size(), 100'000U);
  OccupancyOptions little;
  little.scratch_bytes = 100'000;
  EXPECT_EQ(mapped(rays, 2, little), one);
  for (const int threads : {2, 3, 8}) EXPECT_EQ(mapped(rays, threads), one) << threads;
  OccupancyOptions thin;
  thin.one_ray_per_end_voxel = true;
  const auto thinned = mapped(rays, 1, thin);
  for (const int threads : {2, 3, 8}) EXPECT_EQ(mapped(rays, threads, thin), thinned) << threads;
}

TEST(OccupancyMap, TakesTheSameMemoryForAnyNumberOfThreads) {
  std::set<std::size_t> sizes;
  for (const int threads : {1, 2, 3, 8}) {
    OccupancyMap map({});
    ThreadPool pool(threads);
    for (unsigned i = 0; i < 5; ++i) {
      const TestScan scan(bundle(i, 5000, 25.0F));
      map.add(scan.scan, pool);
    }
    sizes.insert(map.memory_bytes());
  }
  EXPECT_EQ(sizes.size(), 1U);
}

TEST(OccupancyMap, VisitsBlocksInOrderAndFindsTheSameAsLookUp) {
  OccupancyMap map({});
  ThreadPool pool(2);
  const TestScan scan(bundle(6, 5000, 25.0F));
  map.add(scan.scan, pool);
  std::vector<Voxel> order;
  std::size_t blocks = 0;
  map.for_each_block([&](const OccupancyBlock& block) {
    ++blocks;
    order.push_back({block.first.x >> 6, block.first.y >> 6, block.first.z >> 6});
    bool known = false;
    for (int i = 0; i < 512; ++i) {
      const Voxel voxel{block.first.x + i % 8, block.first.y + i / 8 % 8, block.first.z + i / 64};
      ASSERT_EQ(map.at(voxel), block.values[static_cast<std::size_t>(i)]);
      known = known || map.at(voxel) != unknown_log_odds;
    }
    ASSERT_TRUE(known);
  });
  EXPECT_TRUE(std::ranges::is_sorted(order, [](const Voxel& a, const Voxel& b) { return a < b; }));
  EXPECT_EQ(blocks, map.block_count());
  EXPECT_GT(blocks, 1000U);
}

TEST(OccupancyMap, CastsOneRayAnEndVoxelIfAsked) {
  const auto rays = bundle(7, 3000, 3.0F);
  std::vector<TestRay> first;
  std::set<Voxel> ends;
  std::size_t left_out = 0;
  for (const TestRay& ray : rays) {
    const bool fresh = ends.insert(*voxel_at({}, ray.end.cast<double>())).second;
    if (fresh || !ray.hit) {
      first.push_back(ray);
    } else {
      ++left_out;
    }
    if (!ray.hit && fresh) ends.erase(*voxel_at({}, ray.end.cast<double>()));
  }
  OccupancyOptions thin;
  thin.one_ray_per_end_voxel = true;
  EXPECT_EQ(mapped(rays, 1, thin), mapped(first, 1));
  OccupancyMap map({}, thin);
  ThreadPool pool(1);
  const TestScan scan(rays);
  EXPECT_EQ(map.add(scan.scan, pool).thinned, left_out);
  EXPECT_GT(left_out, 100U);
}

TEST(OccupancyMap, ForgetsNothingOfTheScanBefore) {
  const auto a = bundle(8, 2000, 10.0F);
  const auto b = bundle(9, 100, 3.0F);
  for (const bool thin : {false, true}) {
    OccupancyOptions options;
    options.one_ray_per_end_voxel = thin;
    OccupancyMap map({}, options);
    ThreadPool pool(1);
    const TestScan scan_a(a);
    const TestScan scan_b(b);
    map.add(scan_a.scan, pool);
    const auto before = content(map);
    map.add(scan_b.scan, pool);
    const auto change = mapped(b, 1, options);
    for (const auto& [voxel, value] : content(map)) {
      const int was = before.contains(voxel) ? before.at(voxel) : 0;
      const int step = change.contains(voxel) ? change.at(voxel) : 0;
      ASSERT_EQ(value, was + step);
    }
  }
}

TEST(OccupancyMap, LayersAreAWindowIntoTheWholeMap) {
  const auto rays = bundle(10, 5000, 20.0F);
  OccupancyGeometry geometry;
  geometry.layers = LayerRange{-3, 4};
  auto expected = mapped(rays, 1);
  std::erase_if(expected,
                [](const auto& entry) { return entry.first.z < -3 || entry.first.z > 4; });
  EXPECT_EQ(mapped(rays, 1, {}, geometry), expected);
}

TEST(OccupancyMap, OffsetsByWholeVoxelsShiftTheMap) {
  const auto rays = bundle(11, 3000, 12.0F);
  OccupancyGeometry geometry;
  geometry.voxel_size = {0.25, 0.25, 0.125};
  const auto here = mapped(rays, 1, {}, geometry);
  OccupancyMap map(geometry);
  ThreadPool pool(1);
  const TestScan scan(rays, {10'000.0, -10'000.0, 500.0});
  map.add(scan.scan, pool);
  std::map<Voxel, int> shifted;
  for (const auto& [v, value] : here) shifted[{v.x + 40'000, v.y - 40'000, v.z + 4'000}] = value;
  EXPECT_EQ(content(map), shifted);
}

TEST(OccupancyMap, ABentRayIsOneUpdate) {
  const Eigen::Vector3f bend(3.05F, 1.05F, 0.15F);
  const std::vector<TestRay> rays{{{0.05F, 0.05F, 0.05F}, bend, false}, {bend, {5.05F, 1, 0.5F}}};
  OccupancyMap map({});
  for (const auto& [voxel, value] : mapped(rays, 1)) {
    const bool end = voxel == *voxel_at({}, {5.05, 1, 0.5});
    ASSERT_EQ(value, end ? map.steps().hit : -map.steps().miss);
  }
  EXPECT_TRUE(mapped(rays, 1).contains(*voxel_at({}, bend.cast<double>())));
}

TEST(OccupancyMap, SkipsAndCountsWhatCannotBeMapped) {
  auto rays = bundle(12, 500, 5.0F);
  const auto expected = mapped(rays, 1);
  const Eigen::Vector3f good(1, 2, 3);
  for (const float bad : {nan, infinity, -infinity}) {
    for (int a = 0; a < 3; ++a) {
      Eigen::Vector3f broken = good;
      broken[a] = bad;
      rays.push_back({good, broken});
      rays.insert(rays.begin(), {broken, good, false});
    }
  }
  rays.push_back({good, {1e7F, 0, 0}});  // beyond the last voxel
  rays.push_back({good, {3e5F, 0, 0}});  // too long
  rays.push_back({{1e30F, 0, 0}, good});
  OccupancyMap map({});
  ThreadPool pool(2);
  const TestScan scan(rays);
  const OccupancyUpdate update = map.add(scan.scan, pool);
  EXPECT_EQ(update.rays, 521U);
  EXPECT_EQ(update.non_finite, 18U);
  EXPECT_EQ(update.too_far, 3U);
  EXPECT_EQ(content(map), expected);
}

TEST(OccupancyMap, ReadsANaNMarginAsCarveNothing) {
  const auto voxels = mapped({{{0, 0, 0}, {5, 0.1F, 0.1F}, true, nan},
                              {{0, 0, 0}, {-5, 0.1F, 0.1F}, true, infinity},
                              {{0, 0, 0}, {0.1F, 5, 0.1F}, false, nan}},
                             1);
  EXPECT_EQ(voxels.size(), 2U);  // the two hits
}

TEST(OccupancyMap, UsesTheScansMarginForHitsOnly) {
  const std::vector<Eigen::Vector3f> starts(2, {0.1F, 0.1F, 0.1F});
  const std::vector<Eigen::Vector3f> ends{{4.1F, 0.1F, 0.1F}, {0.1F, 4.1F, 0.1F}};
  const std::vector<std::uint8_t> is_hit{1, 0};
  OccupancyMap map({});
  ThreadPool pool(1);
  map.add({{0, 0, 0}, starts, ends, is_hit, {}, 1.0}, pool);
  EXPECT_TRUE(map.is_occupied({20, 0, 0}));
  for (int i = 0; i < 20; ++i) {
    EXPECT_EQ(map.is_free({i, 0, 0}), i < 15) << i;
    EXPECT_TRUE(map.is_free({0, i, 0})) << i;
  }
  EXPECT_TRUE(map.is_free({0, 20, 0}));
}

TEST(OccupancyMap, RefusesNonsense) {
  EXPECT_THROW(OccupancyMap({{0, 0, 0}, {0.1, 0.0, 0.1}, {}}), Error);
  EXPECT_THROW(OccupancyMap({{0, 0, 0}, {0.1, 0.1, nan}, {}}), Error);
  EXPECT_THROW(OccupancyMap({{nan, 0, 0}, {0.1, 0.1, 0.1}, {}}), Error);
  EXPECT_THROW(OccupancyMap({{0, 0, 0}, {0.1, 0.1, 0.1}, LayerRange{3, 2}}), Error);
  OccupancyMap map({});
  ThreadPool pool(1);
  const std::vector<Eigen::Vector3f> points(3, {1, 1, 1});
  const std::vector<std::uint8_t> flags(2, 1);
  EXPECT_THROW(map.add({{0, 0, 0}, points, {}, {}, {}, 0.0}, pool), Error);
  EXPECT_THROW(map.add({{0, 0, 0}, points, points, flags, {}, 0.0}, pool), Error);
  EXPECT_THROW(map.add({{0, 0, 0}, points, points, {}, {}, -1.0}, pool), Error);
  EXPECT_THROW(map.add({{0, nan, 0}, points, points, {}, {}, 0.0}, pool), Error);
}

TEST(OccupancyMap, KeepsToItsMemoryBound) {
  OccupancyGeometry geometry;
  geometry.voxel_size = {0.1, 0.1, 0.1};
  OccupancyMap map(geometry);
  ThreadPool pool(2);
  for (unsigned i = 0; i < 20; ++i) {
    const TestScan scan(bundle(i % 4, 20'000, 25.0F));
    map.add(scan.scan, pool);
    std::set<Voxel> tiles;
    map.for_each_block([&tiles](const OccupancyBlock& block) {
      tiles.insert({block.first.x >> 6, block.first.y >> 6, block.first.z >> 6});
    });
    ASSERT_LE(map.memory_bytes(), 514 * map.block_count() + 5200 * tiles.size() + 1000);
  }
}

TEST(OccupancyMap, TakesLessMemoryOnceOpenSpaceIsClamped) {
  OccupancyGeometry geometry;
  geometry.voxel_size = {0.1, 0.1, 0.1};
  OccupancyMap map(geometry);
  ThreadPool pool(1);
  std::size_t largest = 0;
  for (unsigned i = 0; i < 60; ++i) {
    std::vector<TestRay> rays = bundle(i, 8'000, 4.0F);
    for (TestRay& ray : rays) ray.end = 4.0F * (ray.end - ray.start).normalized();
    const TestScan scan(rays);
    map.add(scan.scan, pool);
    largest = std::max(largest, map.memory_bytes());
  }
  EXPECT_LT(map.memory_bytes(), largest * 7 / 10);
  EXPECT_LT(map.memory_bytes(), map.block_count() * 512 * 8 / 10);
  std::size_t inside = 0;
  const std::size_t voxels = content(map).size();
  map.for_each_voxel([&](const Voxel& voxel, LogOdds value) {
    const Eigen::Vector3d center = voxel_center(geometry, voxel);
    if (center.norm() > 1.5 || std::abs(center.z()) > 0.5) return;
    ++inside;
    EXPECT_EQ(value, map.steps().min);
  });
  EXPECT_GT(inside, 5'000U);
  // One hit in the middle of it is seen, and changes nothing around.
  const TestScan hit({{{0.01F, 0.01F, 0.01F}, {0.55F, 0.35F, 0.25F}, true, 5.0F}});
  map.add(hit.scan, pool);
  EXPECT_EQ(map.at({5, 3, 2}), map.steps().min + map.steps().hit);
  EXPECT_EQ(map.at({4, 3, 2}), map.steps().min);
  EXPECT_EQ(content(map).size(), voxels);
}

}  // namespace
}  // namespace kissmap
