// SPDX-License-Identifier: MIT
#include "kissmap/evaluation/pose_error.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

#include "kissmap/error.hpp"
#include "kissmap/evaluation/alignment.hpp"
#include "kissmap/evaluation/evaluation.hpp"
#include "support/matchers.hpp"
#include "support/random_walk.hpp"

namespace kissmap {
namespace {

using Pairs = std::vector<std::pair<std::size_t, std::size_t>>;

const Rigid3 far_away = exp((Twist() << 300.0, -50.0, 7.0, 0.4, -1.2, 2.0).finished());

Rigid3 turned(double angle, const Eigen::Vector3d& axis) {
  return {Eigen::Quaterniond(Eigen::AngleAxisd(angle, axis)), Eigen::Vector3d(5.0, -3.0, 2.0)};
}

std::vector<Rigid3> straight(std::size_t poses, const Rigid3& step) {
  std::vector<Rigid3> way(1);
  while (way.size() < poses) way.push_back(way.back() * step);
  return way;
}

PosePairs pairs_of(const std::vector<Rigid3>& reference, const std::vector<Rigid3>& estimate) {
  PosePairs pairs;
  pairs.reference = reference;
  pairs.estimate = estimate;
  return pairs;
}

TEST(Statistics, OfNumbersByHand) {
  const ErrorStatistics s = statistics({4.0, 1.0, 3.0, 0.0});
  EXPECT_DOUBLE_EQ(s.mean, 2.0);
  EXPECT_DOUBLE_EQ(s.median, 2.0);
  EXPECT_DOUBLE_EQ(s.rmse, std::sqrt(26.0 / 4.0));
  EXPECT_DOUBLE_EQ(s.std, std::sqrt(10.0 / 4.0));
  EXPECT_EQ(s.min, 0.0);
  EXPECT_EQ(s.max, 4.0);
  EXPECT_EQ(statistics({5.0, 1.0, 2.0}).median, 2.0);
  EXPECT_EQ(statistics({}).count, 0U);
}

TEST(Align, Se3UndoesAnyRigidMotion) {
  const std::vector<Rigid3> way = winding_way(200, 0.5);
  const auto found = align(way, transformed(far_away.inverse(), way), MapAlignment::se3);
  ASSERT_TRUE(found);
  EXPECT_THAT(*found, PoseNear(far_away, 1e-9, 1e-11));
}

TEST(Align, Se3NeverMirrors) {
  std::vector<Rigid3> way = winding_way(50, 0.5);
  std::vector<Rigid3> mirrored = way;
  for (Rigid3& pose : mirrored) pose.translation.y() *= -1.0;
  const auto found = align(way, mirrored, MapAlignment::se3);
  ASSERT_TRUE(found);
  EXPECT_NEAR(found->rotation.toRotationMatrix().determinant(), 1.0, 1e-12);
}

TEST(Align, IsLeastSquares) {
  const std::vector<Rigid3> way = winding_way(150, 0.5);
  const std::vector<Rigid3> estimate = winding_way(150, 0.5, 3.0);
  for (const MapAlignment how : {MapAlignment::se3, MapAlignment::yaw}) {
    const Rigid3 best = *align(way, estimate, how);
    const auto rmse = [&](const Rigid3& a) {
      return statistics(absolute_error(way, transformed(a, estimate)).translation).rmse;
    };
    for (int axis = 0; axis < 6; ++axis) {
      if (how == MapAlignment::yaw && (axis == 3 || axis == 4)) continue;
      for (const double nudge : {-1e-4, 1e-4}) {
        EXPECT_GT(rmse(exp(nudge * Twist::Unit(axis)) * best), rmse(best)) << axis;
      }
    }
  }
}

TEST(Align, YawLeavesRollAndPitch) {
  const std::vector<Rigid3> way = winding_way(200, 0.5);
  const Rigid3 yaw = turned(2.5, Eigen::Vector3d::UnitZ());
  EXPECT_THAT(*align(way, transformed(yaw.inverse(), way), MapAlignment::yaw),
              PoseNear(yaw, 1e-9, 1e-11));
  const Rigid3 rolled = turned(0.2, Eigen::Vector3d::UnitX());
  const std::vector<Rigid3> estimate = transformed(rolled, way);
  const Rigid3 found = *align(way, estimate, MapAlignment::yaw);
  EXPECT_NEAR((found.rotation * Eigen::Vector3d::UnitZ()).z(), 1.0, 1e-15);
  const PoseErrors errors = absolute_error(way, transformed(found, estimate));
  EXPECT_GE(statistics(errors.rotation).min, 0.19);
  EXPECT_GT(statistics(errors.translation).rmse, 0.1);
}

TEST(Align, FirstAndNone) {
  const std::vector<Rigid3> way = winding_way(20, 0.5);
  const std::vector<Rigid3> estimate = transformed(far_away, winding_way(20, 0.5, 1.0));
  EXPECT_THAT(*align(way, estimate, MapAlignment::first) * estimate[0],
              PoseNear(way[0], 1e-10, 1e-12));
  EXPECT_THAT(*align(way, estimate, MapAlignment::none), PoseNear(Rigid3{}, 0.0, 0.0));
}

TEST(Align, SaysWhenTheRotationIsOpen) {
  const Rigid3 ahead{Eigen::Quaterniond::Identity(), {0.3, 0.4, 0.5}};
  const std::vector<Rigid3> line = straight(100, ahead);
  EXPECT_FALSE(align(line, line, MapAlignment::se3));
  EXPECT_TRUE(align(line, line, MapAlignment::yaw));
  const std::vector<Rigid3> still(10, far_away);
  for (const MapAlignment how : {MapAlignment::se3, MapAlignment::yaw}) {
    EXPECT_FALSE(align(still, still, how));
    EXPECT_FALSE(align({}, {}, how));
  }
  EXPECT_THROW(evaluate(pairs_of(line, line)), Error);
}

TEST(AbsoluteError, DoesNotChangeWithTheFrameOfTheEstimate) {
  const std::vector<Rigid3> way = winding_way(300, 0.5);
  const std::vector<Rigid3> estimate = winding_way(300, 0.5, 2.0);
  const Evaluation here = evaluate(pairs_of(way, estimate));
  const Evaluation there = evaluate(pairs_of(way, transformed(far_away, estimate)));
  EXPECT_GT(here.absolute_translation.rmse, 0.01);
  EXPECT_NEAR(here.absolute_translation.rmse, there.absolute_translation.rmse, 1e-10);
  EXPECT_NEAR(here.absolute_rotation.max, there.absolute_rotation.max, 1e-10);
  for (std::size_t i = 0; i < here.relative.size(); ++i) {
    EXPECT_NEAR(here.relative[i].translation.rmse, there.relative[i].translation.rmse, 1e-10);
  }
}

TEST(RelativeError, OfConstantDriftIsTheDrift) {
  const Rigid3 step = exp((Twist() << 1.0, 0.0, 0.0, 0.0, 0.0, 0.05).finished());
  const Rigid3 drift = exp((Twist() << 0.01, 0.002, -0.003, 0.001, 0.0, 0.004).finished());
  const auto way = straight(500, step);
  const auto estimate = transformed(far_away, straight(500, step * drift));
  const PoseErrors errors = relative_error(
      way, estimate, choose_pairs(estimate, {}, {1.0, DeltaUnit::frames}, PairChoice::consecutive));
  ASSERT_EQ(errors.translation.size(), 499U);
  for (std::size_t i = 0; i < errors.translation.size(); ++i) {
    EXPECT_NEAR(errors.translation[i], drift.translation.norm(), 1e-9);
    EXPECT_NEAR(errors.rotation[i], drift.angle(), 1e-9);
  }
}

TEST(ChoosePairs, OfFrames) {
  const std::vector<Rigid3> way(8);
  const Delta three{3.0, DeltaUnit::frames};
  EXPECT_EQ(choose_pairs(way, {}, three, PairChoice::consecutive), (Pairs{{0, 3}, {3, 6}}));
  EXPECT_EQ(choose_pairs(way, {}, three, PairChoice::all),
            (Pairs{{0, 3}, {1, 4}, {2, 5}, {3, 6}, {4, 7}}));
  const Delta eight{8.0, DeltaUnit::frames};
  EXPECT_TRUE(choose_pairs(way, {}, eight, PairChoice::all).empty());
}

TEST(ChoosePairs, OfMetresBetweenMarks) {
  const auto way = straight(10, {Eigen::Quaterniond::Identity(), {0.0, 0.75, 0.0}});
  // Marks at the first pose 2 m or more behind the last mark: 3, 6, 9.
  EXPECT_EQ(choose_pairs(way, {}, {2.0, DeltaUnit::metres}, PairChoice::consecutive),
            (Pairs{{3, 6}, {6, 9}}));
}

TEST(ChoosePairs, AllOfMetresEqualBruteForce) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> any(0.0, 1.0);
  std::size_t chosen = 0;
  for (int round = 0; round < 100; ++round) {
    std::vector<Rigid3> way(60);
    std::vector<double> distances(60, 0.0);
    for (std::size_t i = 1; i < way.size(); ++i) {
      const double step = random() % 4 == 0 ? 0.0 : any(random);  // standing still, too
      way[i].translation.x() = way[i - 1].translation.x() + step;
      distances[i] = distances[i - 1] + (way[i].translation - way[i - 1].translation).norm();
    }
    const double delta = 0.2 + 5.0 * any(random);
    Pairs expected;
    for (std::size_t i = 0; i + 1 < way.size(); ++i) {
      std::size_t best = i + 1;
      const auto off = [&](std::size_t j) { return std::abs(distances[j] - distances[i] - delta); };
      for (std::size_t j = i + 1; j < way.size(); ++j) best = off(j) < off(best) ? j : best;
      if (off(best) <= 0.1 * delta) expected.emplace_back(i, best);
    }
    chosen += expected.size();
    EXPECT_EQ(choose_pairs(way, {}, {delta, DeltaUnit::metres}, PairChoice::all), expected);
  }
  EXPECT_GT(chosen, 500U);
}

TEST(ChoosePairs, OfSecondsTakesTheNearestStamp) {
  const std::vector<Rigid3> way(6);
  const std::vector<std::int64_t> stamps{
      0, 480'000'000, 990'000'000, 1'020'000'000, 1'500'000'000, 2'200'000'000};
  const Delta second{1.0, DeltaUnit::seconds};
  EXPECT_EQ(choose_pairs(way, stamps, second, PairChoice::all), (Pairs{{0, 2}, {1, 4}}));
  // From 0 to 2; nothing a second behind 2, 3, 4.
  EXPECT_EQ(choose_pairs(way, stamps, second, PairChoice::consecutive), (Pairs{{0, 2}}));
  EXPECT_THROW(choose_pairs(way, {}, second, PairChoice::all), Error);
}

TEST(ChoosePairs, RefusesImpossibleDeltas) {
  const std::vector<Rigid3> way(6);
  for (const Delta& delta : {Delta{0.0, DeltaUnit::metres},
                             Delta{-1.0, DeltaUnit::seconds},
                             Delta{1.5, DeltaUnit::frames},
                             Delta{std::nan(""), DeltaUnit::frames}}) {
    EXPECT_THROW(choose_pairs(way, {1, 2, 3, 4, 5, 6}, delta, PairChoice::all), Error);
  }
}

}  // namespace
}  // namespace kissmap
