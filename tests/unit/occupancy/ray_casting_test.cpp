// SPDX-License-Identifier: MIT
// Which voxels rays carve, against clipping them with every voxel's box.
#include <gtest/gtest.h>

#include <random>

#include "unit/occupancy/ray_oracle.hpp"

namespace kissmap {
namespace {

struct Tally {
  std::size_t sure = 0;
  std::size_t unsure = 0;
};

/// Casts one ray into an empty map and compares every voxel around it with the oracle.
Tally check(const OccupancyGeometry& geometry, const TestRay& ray, const Eigen::Vector3d& offset) {
  OccupancyMap map(geometry);
  ThreadPool pool(1);
  const TestScan scan({ray}, offset);
  const OccupancyUpdate update = map.add(scan.scan, pool);
  EXPECT_EQ(update.non_finite + update.too_far, 0U);
  const Voxel start = *voxel_at(geometry, offset + ray.start.cast<double>());
  const Voxel end = *voxel_at(geometry, offset + ray.end.cast<double>());
  Tally tally;
  std::size_t seen = 0;
  const auto [x0, x1] = std::minmax(start.x, end.x);
  const auto [y0, y1] = std::minmax(start.y, end.y);
  const auto [z0, z1] = std::minmax(start.z, end.z);
  for (std::int32_t z = z0 - 1; z <= z1 + 1; ++z) {
    for (std::int32_t y = y0 - 1; y <= y1 + 1; ++y) {
      for (std::int32_t x = x0 - 1; x <= x1 + 1; ++x) {
        const Voxel voxel{x, y, z};
        const LogOdds value = map.at(voxel);
        if (value != unknown_log_odds) ++seen;
        const bool stored =
            !geometry.layers || (z >= geometry.layers->first && z <= geometry.layers->last);
        if (stored && ray.hit && voxel == end) {
          EXPECT_EQ(value, map.steps().hit);
          continue;
        }
        const Crossing expected = stored ? carves(geometry, offset, ray, voxel) : Crossing::no;
        if (expected == Crossing::unsure) {
          ++tally.unsure;
          continue;
        }
        ++tally.sure;
        EXPECT_EQ(value, expected == Crossing::yes ? -map.steps().miss : unknown_log_odds)
            << "voxel " << x << " " << y << " " << z << ", ray from " << ray.start.transpose()
            << " to " << ray.end.transpose() << " hit " << ray.hit << " margin " << ray.margin;
      }
    }
  }
  EXPECT_EQ(seen, content(map).size()) << "voxels far from the ray";
  return tally;
}

class Rays {
 public:
  explicit Rays(unsigned seed) : random_(seed) {}
  float uniform(float low, float high) {
    return std::uniform_real_distribution<float>(low, high)(random_);
  }
  Eigen::Vector3f point(float reach) {
    return {uniform(-reach, reach), uniform(-reach, reach), uniform(-reach, reach)};
  }
  bool coin() { return uniform(0.0F, 1.0F) < 0.5F; }
  TestRay ray(float reach) {
    TestRay ray{point(reach), point(reach), coin(), 0.0F};
    if (coin()) ray.margin = uniform(0.0F, 1.2F * reach);
    return ray;
  }

 private:
  std::mt19937 random_;
};

TEST(RayCasting, CarvesWhatRaysCross) {
  Rays rays(1);
  Tally all;
  for (int i = 0; i < 3000; ++i) {
    OccupancyGeometry geometry;
    geometry.origin = rays.point(1.0F).cast<double>();
    geometry.voxel_size = {0.25, 0.25, rays.coin() ? 0.25 : rays.uniform(0.05F, 0.6F)};
    const Tally tally = check(geometry, rays.ray(2.0F), Eigen::Vector3d::Zero());
    all.sure += tally.sure;
    all.unsure += tally.unsure;
    if (HasFailure()) return;
  }
  EXPECT_LT(all.unsure * 10'000, all.sure);
}

TEST(RayCasting, CarvesWhatRaysCrossOverManyTiles) {
  Rays rays(2);
  OccupancyGeometry geometry;
  geometry.voxel_size = {0.1, 0.1, 0.1};
  for (int i = 0; i < 60; ++i) {
    TestRay ray = rays.ray(15.0F);
    const int thin = static_cast<int>(rays.uniform(0.0F, 2.999F));
    ray.start[thin] *= 0.05F;  // keeps the box around the ray small
    ray.end[thin] *= 0.05F;
    check(geometry, ray, Eigen::Vector3d::Zero());
    if (HasFailure()) return;
  }
}

TEST(RayCasting, TenKilometresAwayNothingChanges) {
  Rays rays(3);
  OccupancyGeometry geometry;
  geometry.voxel_size = {0.05, 0.05, 0.05};
  for (int i = 0; i < 500; ++i) {
    check(geometry, rays.ray(0.6F), {10'000.0, -10'000.0, 500.0});
    if (HasFailure()) return;
  }
}

TEST(RayCasting, AlongAxesAndInFaces) {
  Rays rays(4);
  OccupancyGeometry geometry;
  geometry.voxel_size = {0.5, 0.5, 0.5};
  for (int i = 0; i < 1000; ++i) {
    TestRay ray = rays.ray(3.0F);
    const int along = i % 3;
    for (int a = 0; a < 3; ++a) {
      if (rays.coin()) ray.start[a] = std::round(2.0F * ray.start[a]) / 2.0F;  // in a face
      if (a != along || rays.coin()) ray.end[a] = ray.start[a];
    }
    check(geometry, ray, Eigen::Vector3d::Zero());
    if (HasFailure()) return;
  }
}

TEST(RayCasting, ThroughEdgesAndCorners) {
  Rays rays(5);
  OccupancyGeometry geometry;
  geometry.voxel_size = {0.5, 0.5, 0.5};
  for (int i = 0; i < 1000; ++i) {
    TestRay ray = rays.ray(4.0F);
    for (int a = 0; a < 3; ++a) {
      ray.start[a] = std::round(4.0F * ray.start[a]) / 4.0F;
      ray.end[a] = std::round(4.0F * ray.end[a]) / 4.0F;
    }
    check(geometry, ray, Eigen::Vector3d::Zero());
    if (HasFailure()) return;
  }
}

TEST(RayCasting, NearlyAlongAnAxis) {
  Rays rays(6);
  for (int i = 0; i < 300; ++i) {
    TestRay ray = rays.ray(8.0F);
    const float tilt = std::pow(10.0F, rays.uniform(-9.0F, -2.0F));
    const Eigen::Vector3f change = tilt * rays.point(1.0F);
    const int along = i % 3;
    for (int a = 0; a < 3; ++a) {
      if (a != along) ray.end[a] = ray.start[a] + change[a];
    }
    check({}, ray, Eigen::Vector3d::Zero());
    if (HasFailure()) return;
  }
}

TEST(RayCasting, KeepsToItsLayers) {
  Rays rays(7);
  OccupancyGeometry geometry;
  geometry.voxel_size = {0.25, 0.25, 0.1};
  geometry.origin.z() = 0.03;
  for (int i = 0; i < 2000; ++i) {
    const auto first = static_cast<std::int32_t>(std::floor(rays.uniform(-15.0F, 15.0F)));
    geometry.layers = LayerRange{first, first + static_cast<std::int32_t>(rays.uniform(0, 6))};
    check(geometry, rays.ray(1.5F), Eigen::Vector3d::Zero());
    if (HasFailure()) return;
  }
}

TEST(RayCasting, OfNoLengthOrInsideOneVoxel) {
  for (const bool hit : {true, false}) {
    for (const float margin : {0.0F, 0.05F, 1.0F}) {
      check({}, {{0.31F, 0.52F, -0.7F}, {0.31F, 0.52F, -0.7F}, hit, margin}, {0, 0, 0});
      check({}, {{0.31F, 0.52F, -0.7F}, {0.22F, 0.55F, -0.65F}, hit, margin}, {0, 0, 0});
      check({}, {{0.22F, 0.55F, -0.65F}, {0.31F, 0.52F, -0.7F}, hit, margin}, {0, 0, 0});
    }
  }
}

TEST(RayCasting, MillionVoxelsLongStaysOnItsLine) {
  const OccupancyGeometry geometry;
  OccupancyMap map(geometry);
  ThreadPool pool(1);
  const TestRay ray{{0.05F, 0.05F, 0.05F}, {200'000.0F, 31'234.0F, -4'321.0F}, false, 0.0F};
  const TestScan scan({ray});
  const OccupancyUpdate update = map.add(scan.scan, pool);
  EXPECT_EQ(update.too_far, 0U);
  EXPECT_NEAR(static_cast<double>(update.missed_voxels), 5.0 * (200'000 + 31'234 + 4'321), 4.0);
  std::size_t wrong = 0;
  map.for_each_voxel([&](const Voxel& voxel, LogOdds) {
    if (carves(geometry, {0, 0, 0}, ray, voxel, 1e-4) == Crossing::no) ++wrong;
  });
  EXPECT_EQ(wrong, 0U);
}

}  // namespace
}  // namespace kissmap
