// SPDX-License-Identifier: MIT
#include "kissmap/graph/trajectory_spread.hpp"

#include <gtest/gtest.h>

#include <chrono>

#include "kissmap/error.hpp"
#include "kissmap/graph/pose_graph.hpp"
#include "support/loop_graph.hpp"
#include "support/matchers.hpp"

namespace kissmap {
namespace {

constexpr double metres = 0.02;  // of the odometry from scan to scan
constexpr double radians = 0.0005;

/// Two laps of scans a metre apart in local maps of 50, as drifting odometry sees them.
struct Drive {
  std::vector<Rigid3> truth;
  std::vector<Rigid3> odometry;
  std::vector<ScanPlace> places;
  std::vector<Rigid3> keyposes;
  std::vector<std::size_t> scan_of_keypose;
};

Drive drive(std::mt19937& random, int scans, int per_map = 50) {
  Drive d;
  const double radius = scans / (4.0 * std::numbers::pi);
  LoopGraphOptions options{.nodes = scans, .radius = radius, .metres = metres, .radians = radians};
  options.max_closures = 0;
  const LoopGraph loop = loop_graph(random, options);
  const Rigid3 origin = loop.truth.front().inverse();
  for (const Rigid3& pose : loop.truth) d.truth.push_back(origin * pose);
  for (const Rigid3& pose : loop.graph.map_from_node) d.odometry.push_back(origin * pose);
  d.keyposes.push_back(d.odometry.front());
  d.scan_of_keypose.push_back(0);
  for (std::size_t i = 0; i < d.odometry.size(); ++i) {
    const auto id = static_cast<std::uint32_t>(d.keyposes.size() - 1);
    d.places.push_back({id, d.keyposes.back().inverse() * d.odometry[i]});
    if (d.places.size() % static_cast<std::size_t>(per_map) != 0 || i + 1 == d.odometry.size()) {
      continue;
    }
    d.keyposes.push_back(d.odometry[i]);
    d.scan_of_keypose.push_back(i);
  }
  return d;
}

TEST(TrajectorySpread, WithoutCorrectionNothingChanges) {
  std::mt19937 random(1);
  const Drive d = drive(random, 500);
  const std::vector<Rigid3> spread = spread_corrections(d.places, d.keyposes, d.keyposes);
  ASSERT_EQ(spread.size(), d.odometry.size());
  for (std::size_t i = 0; i < spread.size(); ++i) {
    EXPECT_THAT(spread[i], PoseNear(d.odometry[i], 1e-9, 1e-9));
  }
}

TEST(TrajectorySpread, CorrectionsAppearAtTheKeyposesAndAreSmoothBetween) {
  std::mt19937 random(2);
  const Drive d = drive(random, 500);
  std::vector<Rigid3> after = d.keyposes;
  for (Rigid3& keypose : after) keypose = keypose * noise(random, 1.0, 0.03);
  const std::vector<Rigid3> spread = spread_corrections(d.places, d.keyposes, after);
  for (std::size_t k = 1; k < after.size(); ++k) {
    EXPECT_THAT(spread[d.scan_of_keypose[k]], PoseNear(after[k], 1e-9, 1e-9));
  }
  double largest = 0.0;
  for (std::size_t i = 1; i < spread.size(); ++i) {
    const Rigid3 was = d.odometry[i - 1].inverse() * d.odometry[i];
    const Rigid3 is = spread[i - 1].inverse() * spread[i];
    largest = std::max(largest, (was.inverse() * is).translation.norm());
  }
  // Corrections of some metres over 50 motions: no motion takes more than a few of its shares.
  EXPECT_LT(largest, 0.3);
  EXPECT_GT(largest, 0.01);
  const std::size_t last_key = d.scan_of_keypose.back();
  for (std::size_t i = last_key + 1; i < spread.size(); ++i) {
    EXPECT_THAT(spread[i], PoseNear(after.back() * d.places[i].local_map_from_lidar, 1e-12, 1e-12));
  }
}

TEST(TrajectorySpread, MovingAllKeyposesMovesTheTrajectoryAsAWhole) {
  std::mt19937 random(3);
  const Drive d = drive(random, 300);
  const Rigid3 motion = random_pose(random, 100.0);
  std::vector<Rigid3> after = d.keyposes;
  for (Rigid3& keypose : after) keypose = motion * keypose;
  const std::vector<Rigid3> spread = spread_corrections(d.places, d.keyposes, after);
  for (std::size_t i = 0; i < spread.size(); ++i) {
    EXPECT_THAT(spread[i], PoseNear(motion * d.odometry[i], 1e-7, 1e-7));
  }
}

/// Closures between scans at keyposes, one lap apart, with the truth and a little noise.
std::vector<PoseGraphEdge> closures(const Drive& d, std::mt19937& random, bool between_scans) {
  std::vector<PoseGraphEdge> edges;
  const std::size_t lap = d.keyposes.size() / 2;
  for (std::size_t k = 1; k + lap < d.keyposes.size(); ++k) {
    const std::size_t from = d.scan_of_keypose[k];
    const std::size_t to = d.scan_of_keypose[k + lap];
    PoseGraphEdge edge{static_cast<std::uint32_t>(between_scans ? from : k),
                       static_cast<std::uint32_t>(between_scans ? to : k + lap),
                       d.truth[from].inverse() * d.truth[to] * noise(random, 0.05, 0.002),
                       information_of(0.05, 0.002),
                       EdgeKind::closure};
    edges.push_back(edge);
  }
  return edges;
}

PoseGraphEdge odometry_edge(const std::vector<Rigid3>& poses, std::size_t to, double scans) {
  const double spread = std::sqrt(scans);
  return {static_cast<std::uint32_t>(to - 1),
          static_cast<std::uint32_t>(to),
          poses[to - 1].inverse() * poses[to],
          information_of(spread * metres, spread * radians),
          EdgeKind::odometry};
}

TEST(TrajectorySpread, IsAlmostAsGoodAsOneOptimisationOverAllScans) {
  double sum_before = 0.0;
  double sum_two_steps = 0.0;
  double sum_joint = 0.0;
  for (unsigned seed = 0; seed < 5; ++seed) {
    std::mt19937 random(seed);
    const Drive d = drive(random, 2000);
    std::mt19937 same = random;

    PoseGraph keys;
    keys.map_from_node = d.keyposes;
    for (std::size_t k = 1; k < d.keyposes.size(); ++k) {
      keys.edges.push_back(odometry_edge(d.keyposes, k, 50.0));
    }
    for (const PoseGraphEdge& edge : closures(d, random, false)) keys.edges.push_back(edge);
    PoseGraphOptions plain;
    plain.robust = false;
    const std::vector<Rigid3> after = optimize(keys, plain).map_from_node;
    const std::vector<Rigid3> two_steps = spread_corrections(d.places, d.keyposes, after);

    PoseGraph all;
    all.map_from_node = d.odometry;
    for (std::size_t i = 1; i < d.odometry.size(); ++i) {
      all.edges.push_back(odometry_edge(d.odometry, i, 1.0));
    }
    for (const PoseGraphEdge& edge : closures(d, same, true)) all.edges.push_back(edge);
    const std::vector<Rigid3> joint = optimize(all, plain).map_from_node;

    sum_before += position_error(d.odometry, d.truth);
    sum_two_steps += position_error(two_steps, d.truth);
    sum_joint += position_error(joint, d.truth);
  }
  RecordProperty("before", std::to_string(sum_before / 5));
  RecordProperty("two_steps", std::to_string(sum_two_steps / 5));
  RecordProperty("joint", std::to_string(sum_joint / 5));
  EXPECT_LT(sum_two_steps, 0.9 * sum_before);
  EXPECT_LT(sum_two_steps, 1.2 * sum_joint);
}

TEST(TrajectorySpread, TwentyThousandScansAreQuick) {
  std::mt19937 random(4);
  const Drive d = drive(random, 20000, 100);
  std::vector<Rigid3> after = d.keyposes;
  for (Rigid3& keypose : after) keypose = keypose * noise(random, 1.0, 0.02);
  const auto begin = std::chrono::steady_clock::now();
  const std::vector<Rigid3> spread = spread_corrections(d.places, d.keyposes, after);
  const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - begin;
  ASSERT_EQ(spread.size(), 20000U);
  for (std::size_t k = 1; k < after.size(); ++k) {
    EXPECT_THAT(spread[d.scan_of_keypose[k]], PoseNear(after[k], 1e-9, 1e-9));
  }
#ifdef NDEBUG
  EXPECT_LT(seconds.count(), 20.0);  // 0.3 s on two busy cores; far more if it were not linear
#endif
  RecordProperty("seconds", std::to_string(seconds.count()));
}

TEST(TrajectorySpread, NonsenseIsRefused) {
  std::mt19937 random(5);
  Drive d = drive(random, 200);
  EXPECT_TRUE(spread_corrections({}, d.keyposes, d.keyposes).empty());
  std::vector<Rigid3> fewer = d.keyposes;
  fewer.pop_back();
  EXPECT_THROW(spread_corrections(d.places, d.keyposes, fewer), Error);
  EXPECT_THROW(spread_corrections(d.places, fewer, fewer), Error);
  std::swap(d.places.front(), d.places.back());
  EXPECT_THROW(spread_corrections(d.places, d.keyposes, d.keyposes), Error);
}

}  // namespace
}  // namespace kissmap
