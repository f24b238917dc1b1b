// SPDX-License-Identifier: MIT
#include "kissmap/odometry/registration.hpp"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>

#include "support/matchers.hpp"
#include "support/random_clouds.hpp"

namespace kissmap {
namespace {

constexpr double sigma = 0.5;

Rigid3 small_motion() {
  Twist twist;
  twist << 0.25, -0.15, 0.05, 0.01, -0.02, 0.04;
  return exp(twist);
}

VoxelHashMap map_of(const std::vector<Eigen::Vector3f>& points) {
  VoxelHashMap map(1.0, 20);
  map.add(points);
  return map;
}

Alignment align(const std::vector<Eigen::Vector3f>& source,
                const VoxelHashMap& map,
                const Rigid3& guess,
                int threads = 1) {
  ThreadPool pool(threads);
  Registration registration({}, pool);
  return registration.align(source, map, guess, 3.0 * sigma, sigma);
}

/// The published loop, written down plainly: every pair searched in every iteration, full
/// Jacobians.
Alignment align_plainly(const std::vector<Eigen::Vector3f>& source,
                        const VoxelHashMap& map,
                        const Rigid3& guess) {
  Alignment alignment{guess, Alignment::End::max_iterations, 0, 0};
  for (; alignment.iterations < 500; ++alignment.iterations) {
    Eigen::Matrix<double, 6, 6> normal = Eigen::Matrix<double, 6, 6>::Zero();
    Twist gradient = Twist::Zero();
    for (const Eigen::Vector3f& p : source) {
      const Eigen::Vector3d q = alignment.map_from_lidar * p.cast<double>();
      const auto neighbor = map.nearest(q.cast<float>(), 3.0 * sigma);
      if (!neighbor.found) continue;
      const Eigen::Vector3d r = q - neighbor.point.cast<double>();
      Eigen::Matrix<double, 3, 6> jacobian = Eigen::Matrix<double, 3, 6>::Identity();
      jacobian.rightCols<3>() << 0, q.z(), -q.y(), -q.z(), 0, q.x(), q.y(), -q.x(), 0;
      const double w = std::pow(sigma / (sigma + r.squaredNorm()), 2);
      normal += w * jacobian.transpose() * jacobian;
      gradient += w * jacobian.transpose() * r;
    }
    const Twist step = normal.ldlt().solve(-gradient);
    alignment.map_from_lidar = exp(step) * alignment.map_from_lidar;
    if (step.norm() < 1e-4) break;
  }
  ++alignment.iterations;
  return alignment;
}

TEST(Registration, FindsAKnownMotion) {
  std::mt19937 random(41);
  const auto model = room_cloud(random, 20'000);
  const VoxelHashMap map = map_of(model);
  // The scan holds exactly the map's own points, so the true pose has zero residual.
  const auto scan = moved(small_motion().inverse(), map.points());
  const Alignment found = align(scan, map, Rigid3{});
  EXPECT_EQ(found.end, Alignment::End::converged);
  EXPECT_THAT(found.map_from_lidar, PoseNear(small_motion(), 2e-3, 2e-4));
}

TEST(Registration, SkippedSearchesChangeNothing) {
  std::mt19937 random(42);
  for (int trial = 0; trial < 5; ++trial) {
    const VoxelHashMap map = map_of(room_cloud(random, 15'000));
    const auto scan = moved(small_motion().inverse(), room_cloud(random, 1500));
    const Alignment fast = align(scan, map, Rigid3{});
    const Alignment plain = align_plainly(scan, map, Rigid3{});
    EXPECT_EQ(fast.iterations, plain.iterations);
    EXPECT_THAT(fast.map_from_lidar, PoseNear(plain.map_from_lidar, 1e-9, 1e-10));
  }
}

TEST(Registration, IsEquivariantUnderMotionsOfTheScan) {
  std::mt19937 random(43);
  const VoxelHashMap map = map_of(room_cloud(random, 15'000));
  const auto scan = moved(small_motion().inverse(), room_cloud(random, 1500));
  Twist twist;
  twist << 3.0, 2.0, -1.0, 0.3, 0.7, -1.1;
  const Rigid3 g = exp(twist);  // another sensor frame
  const Alignment here = align(scan, map, Rigid3{});
  const Alignment there = align(moved(g, scan), map, g.inverse());
  EXPECT_THAT(there.map_from_lidar * g, PoseNear(here.map_from_lidar, 1e-4, 1e-5));
}

TEST(Registration, IsEquivariantUnderWholeVoxelShiftsOfTheMap) {
  std::mt19937 random(44);
  const auto model = room_cloud(random, 15'000);
  const auto scan = moved(small_motion().inverse(), room_cloud(random, 1500));
  Rigid3 shift;
  shift.translation = Eigen::Vector3d(16.0, -8.0, 4.0);
  const Alignment here = align(scan, map_of(model), Rigid3{});
  const Alignment there = align(scan, map_of(moved(shift, model)), shift);
  EXPECT_THAT(shift.inverse() * there.map_from_lidar, PoseNear(here.map_from_lidar, 1e-3, 1e-4));
}

TEST(Registration, BitIdenticalForAnyNumberOfThreads) {
  std::mt19937 random(45);
  const VoxelHashMap map = map_of(room_cloud(random, 15'000));
  const auto scan = moved(small_motion().inverse(), room_cloud(random, 6000));
  const Alignment alone = align(scan, map, Rigid3{});
  for (const int threads : {2, 5, 8}) {
    const Alignment shared = align(scan, map, Rigid3{}, threads);
    EXPECT_EQ(shared.map_from_lidar.matrix(), alone.map_from_lidar.matrix());
    EXPECT_EQ(shared.iterations, alone.iterations);
  }
}

TEST(Registration, SaysSoWhenNothingMatches) {
  std::mt19937 random(46);
  const auto scan = room_cloud(random, 500);
  Rigid3 far_away;
  far_away.translation.x() = 1000.0;
  const VoxelHashMap empty(1.0, 20);
  EXPECT_EQ(align(scan, empty, Rigid3{}).end, Alignment::End::no_pairs);
  const Alignment lost = align(scan, map_of(scan), far_away);
  EXPECT_EQ(lost.end, Alignment::End::no_pairs);
  EXPECT_THAT(lost.map_from_lidar, PoseNear(far_away, 0.0, 0.0));
  EXPECT_EQ(align({}, map_of(scan), Rigid3{}).end, Alignment::End::no_pairs);
}

TEST(Registration, SurvivesGeometryThatDoesNotFixThePose) {
  // One point, and points on a line: the motion along or about them is free, but must stay finite.
  const VoxelHashMap one = map_of({{5.0F, 0.0F, 0.0F}});
  EXPECT_TRUE(align({{5.1F, 0.0F, 0.0F}}, one, Rigid3{}).map_from_lidar.matrix().allFinite());
  std::vector<Eigen::Vector3f> line;
  for (int i = 0; i < 50; ++i) line.emplace_back(0.3F * static_cast<float>(i), 0.0F, 0.0F);
  EXPECT_TRUE(align(line, map_of(line), small_motion()).map_from_lidar.matrix().allFinite());
}

}  // namespace
}  // namespace kissmap
