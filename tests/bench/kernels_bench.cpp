// SPDX-License-Identifier: MIT
// The odometry's kernels on clouds of a 64-ring sensor's size. Run in a release build.
#include <benchmark/benchmark.h>

#include "kissmap/cloud/voxel_filter.hpp"
#include "kissmap/odometry/preprocess.hpp"
#include "kissmap/odometry/registration.hpp"
#include "support/random_clouds.hpp"

namespace kissmap {
namespace {

constexpr std::size_t scan_size = 120'000;

/// A street: ground, two rows of houses, seen with a density that falls with range.
std::vector<Eigen::Vector3f> street(std::size_t count) {
  std::mt19937 random(1);
  std::uniform_real_distribution<float> unit(0.0F, 1.0F);
  std::vector<Eigen::Vector3f> points;
  points.reserve(count);
  while (points.size() < count) {
    const float x = (unit(random) < 0.5F ? -1.0F : 1.0F) * 80.0F * unit(random) * unit(random);
    const float pick = unit(random);
    if (pick < 0.5F) {
      points.emplace_back(x, 20.0F * unit(random) - 10.0F, -1.8F);
    } else {
      const float setback = std::floor(unit(random) * 3.0F);
      points.emplace_back(
          x, pick < 0.75F ? 10.0F + setback : -10.0F - setback, 8.0F * unit(random) - 1.8F);
    }
  }
  return points;
}

Scan street_scan() {
  Scan scan;
  scan.points = street(scan_size);
  scan.time_source = TimeSource::recorded;
  for (std::size_t i = 0; i < scan_size; ++i) {
    scan.time_offsets.push_back(0.1F * static_cast<float>(i) / scan_size);
  }
  return scan;
}

Rigid3 motion() {
  Twist twist;
  twist << 1.0, 0.02, 0.0, 0.0, 0.0, 0.03;
  return exp(twist);
}

void deskew(benchmark::State& state) {
  const Scan scan = street_scan();
  ThreadPool pool(static_cast<int>(state.range(0)));
  std::vector<Eigen::Vector3f> kept;
  for (auto _ : state) {
    deskew_and_crop(scan, sweep_motion(scan, motion()), 0.0, 100.0, pool, kept);
    benchmark::DoNotOptimize(kept.data());
  }
  state.SetItemsProcessed(static_cast<std::int64_t>(state.iterations() * scan_size));
}
BENCHMARK(deskew)->Arg(1)->Arg(2)->UseRealTime();

void voxel_filter(benchmark::State& state) {
  const auto points = street(scan_size);
  VoxelFilter filter;
  std::vector<Eigen::Vector3f> kept;
  for (auto _ : state) filter.apply(points, 0.5, kept);
  state.SetItemsProcessed(static_cast<std::int64_t>(state.iterations() * scan_size));
}
BENCHMARK(voxel_filter);

void map_add(benchmark::State& state) {
  const auto points = street(scan_size);
  VoxelHashMap map(1.0, 20);
  for (auto _ : state) {
    map.clear();
    map.add(points);
  }
  state.SetItemsProcessed(static_cast<std::int64_t>(state.iterations() * scan_size));
}
BENCHMARK(map_add);

void nearest_neighbor(benchmark::State& state) {
  VoxelHashMap map(1.0, 20);
  map.add(street(scan_size));
  const auto queries = moved(motion(), street(8192));
  for (auto _ : state) {
    for (const Eigen::Vector3f& query : queries) benchmark::DoNotOptimize(map.nearest(query, 3.0F));
  }
  state.SetItemsProcessed(static_cast<std::int64_t>(state.iterations() * queries.size()));
}
BENCHMARK(nearest_neighbor);

void registration(benchmark::State& state) {
  VoxelHashMap map(1.0, 20);
  map.add(street(scan_size));
  std::vector<Eigen::Vector3f> source;
  VoxelFilter().apply(street(scan_size), 1.5, source);
  ThreadPool pool(static_cast<int>(state.range(0)));
  Registration registration({}, pool);
  for (auto _ : state) {
    benchmark::DoNotOptimize(registration.align(source, map, motion(), 3.0, 1.0));
  }
}
BENCHMARK(registration)->Arg(1)->Arg(2)->UseRealTime();

}  // namespace
}  // namespace kissmap

BENCHMARK_MAIN();
