// SPDX-License-Identifier: MIT
#include "kissmap/occupancy/grazing_margin.hpp"

#include <gtest/gtest.h>

#include <set>

#include "kissmap/error.hpp"
#include "unit/occupancy/grazing_world.hpp"

namespace kissmap {
namespace {

const Eigen::Vector3d cube = Eigen::Vector3d::Constant(0.2);

std::vector<float> margins_of(const std::vector<TestRay>& rays, int threads = 1) {
  ThreadPool pool(threads);
  const TestScan scan(rays);
  return grazing_margins(scan.scan, cube, {}, pool);
}

void add(OccupancyMap& map, std::vector<TestRay> rays, bool with_margins, ThreadPool& pool) {
  if (with_margins) {
    const auto margins = margins_of(rays);
    for (std::size_t i = 0; i < rays.size(); ++i) rays[i].margin = margins[i];
  }
  const TestScan scan(rays);
  map.add(scan.scan, pool);
}

TEST(GrazingMargin, IsTheVoxelsHeightOverTheSineOfTheAngle) {
  GrazingWorld world;
  std::mt19937 random(1);
  Rings rings;
  rings.elevations = steps_between(-10.0, -1.0, 0.7);
  const auto rays = look(world, {0.0F, 0.0F, 0.5F}, rings, random);
  const auto margins = margins_of(rays);
  for (std::size_t i = 0; i < rays.size(); ++i) {
    const float sine = 0.5F / (rays[i].end - rays[i].start).norm();
    ASSERT_NEAR(margins[i] * sine, 0.23F, 0.002F) << "ray to " << rays[i].end.transpose();
  }
}

TEST(GrazingMargin, OfAWallSeenHeadOnIsAboutAVoxel) {
  GrazingWorld world;
  world.boxes = {{{10.0F, -50.0F, -50.0F}, {11.0F, 50.0F, 50.0F}}};
  world.floor = -100.0F;
  std::mt19937 random(2);
  Rings rings{steps_between(-15.0, 15.0, 0.7), -15.0, 15.0, 0.35, 100.0F, 0.02F};
  for (const float margin : margins_of(look(world, {0, 0, 0}, rings, random))) {
    ASSERT_GE(margin, 0.1F);
    ASSERT_LE(margin, 0.5F);
  }
}

TEST(GrazingMargin, StepsInDepthAreNoPlanes) {
  // Posts before a wall: every window at a post's edge holds two surfaces.
  GrazingWorld world;
  world.floor = -100.0F;
  world.boxes = {{{12.0F, -50.0F, -50.0F}, {13.0F, 50.0F, 50.0F}}};
  for (float y = -6.0F; y < 6.0F; y += 2.0F) {
    world.boxes.push_back({{7.0F, y, -50.0F}, {7.5F, y + 0.6F, 50.0F}});
  }
  std::mt19937 random(3);
  Rings rings{steps_between(-15.0, 15.0, 0.7), -30.0, 30.0, 0.35, 100.0F, 0.02F};
  const auto margins = margins_of(look(world, {0, 0, 0}, rings, random));
  const auto wide = std::ranges::count_if(margins, [](float m) { return m > 2.0F; });
  EXPECT_LT(wide, static_cast<std::ptrdiff_t>(margins.size() / 20));
}

/// A robot's view: a floor from 1 to 12 degrees, a wall, a crate that is taken away.
class GrazedFloor : public testing::Test {
 protected:
  struct Outcome {
    double floor_kept = 0.0;  // share of the floor voxels that were hit
    double crate_gone = 0.0;  // share of the crate's voxels, those of the floor left out
    std::size_t carved = 0;
  };

  Outcome drive(bool with_margins, int scans) const {
    GrazingWorld empty;
    empty.floor = -0.07F;
    empty.boxes = {{{36.0F, -40.0F, -1.0F}, {37.0F, 40.0F, 5.0F}}};
    GrazingWorld crate = empty;
    const TestBox box{{10.0F, -1.0F, -1.0F}, {10.6F, 1.0F, 0.8F}};
    crate.boxes.push_back(box);
    OccupancyMap map({});
    ThreadPool pool(1);
    std::mt19937 random(4);
    std::uniform_real_distribution<float> sway(-0.3F, 0.3F);
    Rings rings{steps_between(-12.0, 8.0, 0.7), -25.0, 25.0, 1.0, 100.0F, 0.01F};
    std::set<Voxel> floor, obstacle;
    for (int i = 0; i < scans; ++i) {
      const Eigen::Vector3f sensor(sway(random), sway(random), 0.45F + 0.1F * sway(random));
      const auto rays = look(i < scans / 10 ? crate : empty, sensor, rings, random);
      for (const TestRay& ray : rays) {
        const Voxel end = *voxel_at({}, ray.end.cast<double>());
        if (ray.end.x() > 9.9F && ray.end.x() < 10.7F && ray.end.z() > 0.2F) obstacle.insert(end);
        // The floor lies 7 cm below the upper face of its layer.
        if (end.z == -1 && ray.end.x() < 35.0F) floor.insert(end);
      }
      add(map, rays, with_margins, pool);
    }
    Outcome outcome;
    outcome.floor_kept = share(floor, [&](const Voxel& v) { return map.is_occupied(v); });
    outcome.crate_gone = share(obstacle, [&](const Voxel& v) { return !map.is_occupied(v); });
    map.for_each_voxel([&](const Voxel& v, LogOdds value) {
      if (v.z >= 1 && v.x < 150 && map.steps().is_free(value)) ++outcome.carved;
    });
    return outcome;
  }

  template <class Predicate>
  static double share(const std::set<Voxel>& voxels, const Predicate& predicate) {
    return static_cast<double>(std::ranges::count_if(voxels, predicate)) /
           static_cast<double>(voxels.size());
  }
};

TEST_F(GrazedFloor, SurvivesAThousandScansWhileWhatIsTakenAwayGoes) {
  const Outcome bare = drive(false, 1000);
  const Outcome kept = drive(true, 1000);
  EXPECT_LT(bare.floor_kept, 0.7);  // else the test would show nothing
  EXPECT_GT(kept.floor_kept, 0.995);
  EXPECT_GT(kept.crate_gone, 0.99);
  EXPECT_GT(static_cast<double>(kept.carved), 0.97 * static_cast<double>(bare.carved));
}

TEST(GrazingMargin, WallsSeenAlongSurvive) {
  GrazingWorld corridor;
  corridor.floor = -50.0F;
  corridor.boxes = {{{-40.0F, 1.05F, -2.0F}, {40.0F, 2.0F, 2.0F}},
                    {{-40.0F, -2.0F, -2.0F}, {40.0F, -1.05F, 2.0F}}};
  std::mt19937 random(5);
  std::uniform_real_distribution<float> sway(-0.2F, 0.2F);
  Rings rings{steps_between(-3.0, 3.0, 0.7), -180.0, 180.0, 0.35, 30.0F, 0.01F};
  for (const bool with_margins : {false, true}) {
    OccupancyMap map({});
    ThreadPool pool(1);
    std::set<Voxel> walls;
    for (int i = 0; i < 60; ++i) {
      const auto rays = look(corridor, {sway(random), 3 * sway(random), 0.0F}, rings, random);
      for (const TestRay& ray : rays) {
        const Voxel end = *voxel_at({}, ray.end.cast<double>());
        if (ray.hit && (end.y == 5 || end.y == -6)) walls.insert(end);
      }
      add(map, rays, with_margins, pool);
    }
    const auto kept =
        std::ranges::count_if(walls, [&](const Voxel& v) { return map.is_occupied(v); });
    const double share = static_cast<double>(kept) / static_cast<double>(walls.size());
    if (with_margins) {
      EXPECT_GT(share, 0.995);
    } else {
      EXPECT_LT(share, 0.9);
    }
  }
}

TEST(GrazingMargin, RaysWithoutAHitKeepClearOfTheFloorTheyDipInto) {
  GrazingWorld world;
  world.floor = -0.07F;
  std::mt19937 random(6);
  Rings rings;
  rings.elevations = steps_between(-10.0, -0.9, 0.7);
  rings.max_range = 30.0F;
  auto rays = look(world, {0.0F, 0.0F, 0.5F}, rings, random);
  // A puddle swallows a tenth of what should come back: those rays run on below the floor.
  for (std::size_t i = 0; i < rays.size(); i += 10) {
    rays[i].hit = false;
    rays[i].end = rays[i].start + 30.0F * (rays[i].end - rays[i].start).normalized();
  }
  OccupancyMap map({});
  ThreadPool pool(1);
  add(map, rays, true, pool);
  std::size_t eroded = 0;
  std::size_t open = 0;
  map.for_each_voxel([&](const Voxel& v, LogOdds value) {
    if (map.steps().is_free(value)) ++(v.z <= -1 ? eroded : open);
  });
  EXPECT_EQ(eroded, 0U);
  EXPECT_GT(open, 30'000U);
}

TEST(GrazingMargin, OpenSpaceBetweenClutterIsStillCarved) {
  // A yard with walls that many rays pass over, and thirty boxes.
  GrazingWorld yard;
  yard.floor = -0.07F;
  for (const float side : {-1.0F, 1.0F}) {
    yard.boxes.push_back(
        {{30.0F * side - 0.5F, -20.0F, -1.0F}, {30.0F * side + 0.5F, 20.0F, 5.0F}});
    yard.boxes.push_back(
        {{-30.0F, 20.0F * side - 0.5F, -1.0F}, {30.0F, 20.0F * side + 0.5F, 5.0F}});
  }
  std::mt19937 random(8);
  std::uniform_real_distribution<float> unit(-1.0F, 1.0F);
  while (yard.boxes.size() < 34) {
    const Eigen::Vector3f low(25.0F * unit(random), 18.0F * unit(random), -1.0F);
    if (low.head<2>().norm() < 2.5F) continue;
    const Eigen::Vector3f size(1.0F, 0.7F, 2.5F + unit(random));
    yard.boxes.push_back({low, low + size});
  }
  for (const double step : {0.7, 2.0}) {
    Rings rings{steps_between(-15.0, 15.0, step), -180.0, 180.0, 0.4, 60.0F, 0.02F};
    const auto rays = look(yard, {0.0F, 0.0F, 0.6F}, rings, random);
    ThreadPool pool(1);
    OccupancyMap bare({});
    OccupancyMap careful({});
    add(bare, rays, false, pool);
    add(careful, rays, true, pool);
    std::size_t open = 0;
    std::size_t carved = 0;
    bare.for_each_voxel([&](const Voxel& v, LogOdds value) {
      if (v.z < 1 || !bare.steps().is_free(value)) return;
      ++open;
      if (careful.is_free(v)) ++carved;
    });
    EXPECT_GT(static_cast<double>(carved), (step < 1.0 ? 0.98 : 0.93) * static_cast<double>(open));
  }
}

TEST(GrazingMargin, IsTheSameForAnyNumberOfThreads) {
  GrazingWorld world;
  world.boxes = {{{5.0F, -3.0F, 0.0F}, {6.0F, 3.0F, 2.0F}}};
  std::mt19937 random(7);
  Rings rings{steps_between(-20.0, 10.0, 0.7), -180.0, 180.0, 0.35, 40.0F, 0.02F};
  const auto rays = look(world, {0.0F, 0.0F, 1.5F}, rings, random);
  const auto one = margins_of(rays, 1);
  for (const int threads : {2, 3, 8}) EXPECT_EQ(margins_of(rays, threads), one);
}

TEST(GrazingMargin, TakesAnyInput) {
  EXPECT_TRUE(margins_of({}).empty());
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const float infinity = std::numeric_limits<float>::infinity();
  std::vector<TestRay> rays;
  for (const float bad : {nan, infinity, -infinity, 3e38F}) {
    rays.push_back({{0, 0, 0}, {bad, 1, 1}});
    rays.push_back({{0, bad, 0}, {1, 1, 1}, false});
    rays.push_back({{bad, bad, bad}, {bad, bad, bad}});
  }
  rays.push_back({{1, 1, 1}, {1, 1, 1}});
  for (int i = 0; i < 100; ++i) rays.push_back({{0, 0, 0}, {5, 0, 0}});  // all in one place
  for (int i = 0; i < 100; ++i) rays.push_back({{0, 0, 0}, {0, 0, 5}});  // in the pole
  for (const float margin : margins_of(rays)) ASSERT_EQ(margin, 0.0F);
  ThreadPool pool(1);
  const TestScan scan(rays);
  for (const float margin : grazing_margins(scan.scan, cube, {0.1, 0.03}, pool)) {
    ASSERT_TRUE(margin == 0.1F || margin == 0.0F);
  }
  EXPECT_THROW(grazing_margins(scan.scan, cube, {-0.1, 0.03}, pool), Error);
  EXPECT_THROW(grazing_margins(scan.scan, cube, {0.1, 0.0}, pool), Error);
  RayScan broken = scan.scan;
  broken.ends = broken.ends.first(3);
  EXPECT_THROW(grazing_margins(broken, cube, {}, pool), Error);
}

}  // namespace
}  // namespace kissmap
