// SPDX-License-Identifier: MIT
#include "kissmap/occupancy/moved_returns.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <optional>

#include "kissmap/error.hpp"

namespace kissmap {
namespace {

/// A wall at x = 6 m, a pole of 4 cm before it, and a box that may be there or not; seen from a
/// sensor near the origin.
struct Scene {
  static constexpr double wall = 6.05;
  static constexpr double pole_x = 3.05, pole_y = 0.55, pole_radius = 0.02;
  static constexpr double box_x = 4.05, box_y = -1.0, box_half = 0.3;  // its face, 0.6 m wide
};

/// Where a ray along (1, slope_y, slope_z) from `start` ends.
Eigen::Vector3d end_of(const Eigen::Vector3d& start,
                       double slope_y,
                       double slope_z,
                       bool with_box) {
  const Eigen::Vector3d way(1.0, slope_y, slope_z);
  const Eigen::Vector3d at_pole = start + (Scene::pole_x - start.x()) * way;
  if (std::abs(at_pole.y() - Scene::pole_y) < Scene::pole_radius) return at_pole;
  const Eigen::Vector3d at_box = start + (Scene::box_x - start.x()) * way;
  if (with_box && std::abs(at_box.y() - Scene::box_y) < Scene::box_half) return at_box;
  return start + (Scene::wall - start.x()) * way;
}

PlacedScan scan_of(int scan_idx, bool with_box) {
  PlacedScan scan;
  scan.pose_stamp_ns = scan_idx * std::int64_t{100'000'000};
  scan.map_from_lidar.translation = {0.01 * scan_idx, 0.037 * std::sin(1.7 * scan_idx), 0.02};
  for (int column = -100; column <= 100; ++column) {
    for (int ring = -20; ring <= 20; ++ring) {
      const Eigen::Vector3d end =
          end_of(scan.map_from_lidar.translation, 0.004 * column, 0.01 * ring, with_box);
      scan.points.push_back((end - scan.map_from_lidar.translation).cast<float>());
      scan.origins.emplace_back(Eigen::Vector3f::Zero());
    }
  }
  return scan;
}

constexpr int scans = 40;

/// The box is there in the scans from `first` on and before `end`.
void look(MovedReturns& found, int first, int end, int threads = 1) {
  ThreadPool pool(threads);
  const auto scan = [&](int i) { return scan_of(i, i >= first && i < end); };
  for (int i = 0; i < scans; ++i) found.add_returns(scan(i));
  for (int i = 0; i < scans; ++i) found.add_rays(scan(i), pool);
  found.decide(pool);
}

/// Share of the places of a grid over a part of the plane x that moved.
double moved_share(const MovedReturns& found, double x, double y_from, double y_to) {
  int moved = 0;
  int all = 0;
  for (double y = y_from; y <= y_to; y += 0.02) {
    for (double z = -0.3; z <= 0.3; z += 0.05) {
      moved += found.moved({x, y, z}) ? 1 : 0;
      ++all;
    }
  }
  return static_cast<double>(moved) / all;
}

void expect_the_rest_stays(const MovedReturns& found) {
  EXPECT_EQ(moved_share(found, Scene::wall, -1.5, 1.5), 0.0);
  EXPECT_EQ(moved_share(found, Scene::pole_x, Scene::pole_y, Scene::pole_y), 0.0);
}

TEST(MovedReturns, ABoxThatCameAndWentMoved) {
  for (const auto& [first, end] : {std::pair(0, 10), std::pair(15, 25), std::pair(30, scans)}) {
    MovedReturns found;
    look(found, first, end);
    EXPECT_EQ(moved_share(found, Scene::box_x, -1.25, -0.75), 1.0) << first;
    EXPECT_GT(found.moved_voxels(), 30U);
    expect_the_rest_stays(found);
  }
}

TEST(MovedReturns, ABoxThatStandsStays) {
  MovedReturns found;
  look(found, 0, scans);
  EXPECT_EQ(found.moved_voxels(), 0U);
  expect_the_rest_stays(found);
}

TEST(MovedReturns, ABoxThatWasThereMostOfTheTimeStays) {
  MovedReturns found;
  look(found, 8, scans);
  EXPECT_EQ(moved_share(found, Scene::box_x, -1.25, -0.75), 0.0);
}

TEST(MovedReturns, NothingSeenIsNothingMoved) {
  MovedReturns found;
  ThreadPool pool(1);
  found.add_returns({});
  found.add_rays({}, pool);
  found.decide(pool);
  EXPECT_EQ(found.voxels(), 0U);
  EXPECT_FALSE(found.moved({1.0, 2.0, 3.0}));
  EXPECT_FALSE(found.moved({std::nan(""), 2.0, 3.0}));
}

TEST(MovedReturns, IsTheSameForAnyNumberOfThreads) {
  MovedReturns one;
  MovedReturns three;
  look(one, 15, 25, 1);
  look(three, 15, 25, 3);
  EXPECT_EQ(one.voxels(), three.voxels());
  EXPECT_EQ(one.moved_voxels(), three.moved_voxels());
  for (double y = -2.0; y < 2.0; y += 0.05) {
    ASSERT_EQ(one.moved({Scene::box_x, y, 0.1}), three.moved({Scene::box_x, y, 0.1})) << y;
  }
}

TEST(MovedReturns, RefusesNonsense) {
  EXPECT_THROW(MovedReturns({0.0, 0.75}), Error);
  EXPECT_THROW(MovedReturns({0.1, -1.0}), Error);
}

}  // namespace
}  // namespace kissmap
