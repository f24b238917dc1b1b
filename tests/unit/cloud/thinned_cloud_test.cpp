// SPDX-License-Identifier: MIT
#include "kissmap/cloud/thinned_cloud.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <random>
#include <tuple>

#include "kissmap/error.hpp"

namespace kissmap {
namespace {

constexpr double size = 0.3;

std::vector<MapPoint> random_points(std::size_t count, double extent) {
  std::mt19937 random(9);
  std::uniform_real_distribution<double> coordinate(-extent, extent);
  std::vector<MapPoint> points(count);
  for (std::size_t i = 0; i < count; ++i) {
    points[i].position = {coordinate(random), coordinate(random), coordinate(random)};
    points[i].scan_idx = static_cast<std::uint32_t>(i);  // tells which one it is
  }
  return points;
}

ThinnedCloud thinned(const std::vector<MapPoint>& points, double voxel_size = size) {
  ThinnedCloud cloud(voxel_size);
  for (const MapPoint& point : points) cloud.add(point);
  return cloud;
}

/// The definition, in double precision and with all points at hand: for each voxel, in the order in
/// which they are first seen, the index of the point kept.
std::vector<std::uint32_t> by_brute_force(const std::vector<MapPoint>& points) {
  std::map<std::tuple<double, double, double>, std::vector<std::uint32_t>> voxels;
  for (const MapPoint& p : points) {
    const Eigen::Array3d v = (p.position / size).array().floor();
    voxels[{v.x(), v.y(), v.z()}].push_back(p.scan_idx);
  }
  std::vector<std::pair<std::uint32_t, std::uint32_t>> first_and_kept;
  for (const auto& [voxel, members] : voxels) {
    std::uint32_t kept = members.front();
    for (std::size_t n = 3; n <= members.size(); ++n) {  // two are equally far from their mean
      Eigen::Vector3d mean = Eigen::Vector3d::Zero();
      for (std::size_t i = 0; i < n; ++i) mean += points[members[i]].position;
      mean /= static_cast<double>(n);
      const std::uint32_t last = members[n - 1];
      if ((points[last].position - mean).norm() < (points[kept].position - mean).norm()) {
        kept = last;
      }
    }
    first_and_kept.emplace_back(members.front(), kept);
  }
  std::ranges::sort(first_and_kept);
  std::vector<std::uint32_t> kept;
  for (const auto& [first, index] : first_and_kept) kept.push_back(index);
  return kept;
}

TEST(ThinnedCloud, KeepsThePointTheDefinitionSays) {
  for (const double extent : {0.5, 2.0, 20.0}) {  // from thousands to few points a voxel
    const std::vector<MapPoint> points = random_points(4000, extent);
    const ThinnedCloud cloud = thinned(points);
    const std::vector<std::uint32_t> wanted = by_brute_force(points);
    ASSERT_EQ(cloud.size(), wanted.size());
    EXPECT_EQ(cloud.points_added(), points.size());
    for (std::size_t i = 0; i < cloud.size(); ++i) {
      ASSERT_EQ(cloud[i].scan_idx, wanted[i]) << "voxel " << i << ", extent " << extent;
      ASSERT_EQ(cloud[i].position, points[wanted[i]].position) << "a real point, bit by bit";
    }
  }
}

TEST(ThinnedCloud, HalvesNoiseWhereAVoxelIsSeenOften) {
  std::mt19937 random(2);
  std::normal_distribution<double> noise(0.0, 0.02);
  std::uniform_real_distribution<double> coordinate(0.0, 3.0);
  ThinnedCloud cloud(size);
  for (int i = 0; i < 20'000; ++i) {  // a floor in the middle of its voxels
    MapPoint point;
    point.position = {coordinate(random), coordinate(random), 0.15 + noise(random)};
    cloud.add(point);
  }
  ASSERT_EQ(cloud.size(), 100U);
  double squares = 0.0;
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    squares += std::pow(cloud[i].position.z() - 0.15, 2);
  }
  EXPECT_LT(std::sqrt(squares / 100.0), 0.01);
}

TEST(ThinnedCloud, IsExactFarFromTheOrigin) {
  const Eigen::Vector3d far(90'000.0, -45'000.0, 3.0);  // whole voxels away
  std::vector<MapPoint> points = random_points(500, 2.0);
  const ThinnedCloud near_cloud = thinned(points, 0.25);
  for (MapPoint& point : points) point.position += far;
  const ThinnedCloud far_cloud = thinned(points, 0.25);
  ASSERT_EQ(near_cloud.size(), far_cloud.size());
  for (std::size_t i = 0; i < near_cloud.size(); ++i) {
    ASSERT_EQ(near_cloud[i].scan_idx, far_cloud[i].scan_idx);
  }
}

TEST(ThinnedCloud, RefusesVoxelsItCannotCount) {
  ThinnedCloud cloud(0.001);
  MapPoint point;
  point.position.x() = -1040.0;
  cloud.add(point);
  point.position.x() = 1050.0;
  EXPECT_THROW(cloud.add(point), Error);
  EXPECT_EQ(cloud.size(), 1U);
}

TEST(ThinnedCloud, NormalsStandOnASphereTowardsTheSensor) {
  std::mt19937 random(4);
  std::normal_distribution<double> gauss;
  ThinnedCloud cloud(0.1);
  for (int i = 0; i < 200'000; ++i) {
    MapPoint point;
    const Eigen::Vector3d direction =
        Eigen::Vector3d(gauss(random), gauss(random), gauss(random)).normalized();
    point.position = 3.0 * direction;
    point.to_sensor = (-point.position).cast<float>();  // seen from the middle
    cloud.add(point);
  }
  ThreadPool one(1);
  ThreadPool four(4);
  const std::vector<Eigen::Vector3f> normals = cloud.normals(one);
  ASSERT_EQ(normals.size(), cloud.size());
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    const Eigen::Vector3d inward = -cloud[i].position.normalized();
    ASSERT_GT(normals[i].cast<double>().dot(inward), std::cos(0.1)) << i;
    ASSERT_NEAR(normals[i].norm(), 1.0F, 1e-5F);
  }
  const std::vector<Eigen::Vector3f> again = cloud.normals(four);
  EXPECT_TRUE(std::ranges::equal(normals, again));
}

TEST(ThinnedCloud, HasNoNormalsOnLinesAndLonelyPoints) {
  ThinnedCloud cloud(0.1);
  for (int i = 0; i < 30; ++i) {
    MapPoint point;
    point.position = {0.05 + 0.1 * i, 0.05, 0.05};
    cloud.add(point);
  }
  MapPoint alone;
  alone.position = {50.0, 50.0, 0.0};
  cloud.add(alone);
  ThreadPool pool(1);
  for (const Eigen::Vector3f& normal : cloud.normals(pool)) {
    EXPECT_TRUE(std::isnan(normal.x()) && std::isnan(normal.y()) && std::isnan(normal.z()));
  }
  EXPECT_TRUE(ThinnedCloud(1.0).normals(pool).empty());
}

}  // namespace
}  // namespace kissmap
