// SPDX-License-Identifier: MIT
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

#include "kissmap/error.hpp"
#include "kissmap/evaluation/association.hpp"
#include "support/matchers.hpp"

namespace kissmap {
namespace {

using testing::HasSubstr;

constexpr std::int64_t start_ns = 1'700'000'000'000'000'000;

std::int64_t ns(double seconds) {
  return start_ns + std::llround(seconds * 1e9);
}

// Steadily along a helix: 0.8 rad/s, 5 m/s, climbing by 0.3 m/s. The closed form of a constant
// twist.
Rigid3 helix_at(double seconds) {
  constexpr double turn = 0.8;
  constexpr double radius = 5.0 / turn;
  const double yaw = turn * seconds;
  return {Eigen::Quaterniond(Eigen::AngleAxisd(yaw, Eigen::Vector3d::UnitZ())),
          {radius * std::sin(yaw), radius * (1.0 - std::cos(yaw)), 0.3 * seconds}};
}

Trajectory helix(const std::vector<double>& seconds) {
  Trajectory trajectory;
  for (const double t : seconds) {
    trajectory.stamps_ns.push_back(ns(t));
    trajectory.poses.push_back(helix_at(t));
  }
  return trajectory;
}

std::vector<double> steps(double first, double step, int count) {
  std::vector<double> seconds;
  for (int i = 0; i < count; ++i) seconds.push_back(first + i * step);
  return seconds;
}

AssociationOptions interpolating(double max_gap = 0.25, double offset = 0.0) {
  AssociationOptions options;
  options.interpolate = true;
  options.max_gap = max_gap;
  options.offset = offset;
  return options;
}

std::string error_of(const Trajectory& reference,
                     const Trajectory& estimate,
                     const AssociationOptions& options) {
  try {
    associate(reference, estimate, options);
  } catch (const Error& error) {
    return error.what();
  }
  return "no error";
}

TEST(Interpolate, IsExactForAConstantTwist) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> any(0.0, 9.9);
  std::vector<double> instants;
  for (int i = 0; i < 100; ++i) instants.push_back(any(random));
  std::ranges::sort(instants);
  const PosePairs pairs = associate(helix(steps(0.0, 0.1, 100)), helix(instants), interpolating());
  EXPECT_EQ(pairs.interpolated, PosePairs::Side::reference);
  EXPECT_TRUE(pairs.by_stamp);
  ASSERT_EQ(pairs.size(), 100U);
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    EXPECT_THAT(pairs.reference[i], PoseNear(helix_at(instants[i]), 1e-8, 1e-8));
    EXPECT_THAT(pairs.estimate[i], PoseNear(helix_at(instants[i]), 0.0, 1e-15));
    EXPECT_EQ(pairs.stamps_ns[i], ns(instants[i]));
  }
}

// As Boreas has it: as many poses on both sides, half a sweep apart.
TEST(Interpolate, OfAsManyPosesTheReferenceIsInterpolated) {
  const PosePairs pairs =
      associate(helix(steps(0.0, 0.1, 10)), helix(steps(0.05, 0.1, 10)), interpolating());
  EXPECT_EQ(pairs.interpolated, PosePairs::Side::reference);
  ASSERT_EQ(pairs.size(), 9U);  // the last has no reference behind it
  EXPECT_THAT(pairs.reference[8], PoseNear(helix_at(0.85), 1e-9, 1e-9));
  EXPECT_EQ(pairs.reference_idx[8], 8U);
}

// As Hilti has it: a few control points.
TEST(Interpolate, OfASparseReferenceTheEstimateIsInterpolated) {
  const Trajectory reference = helix({0.33, 4.27, 7.71});
  const PosePairs pairs = associate(reference, helix(steps(0.0, 0.1, 100)), interpolating());
  EXPECT_EQ(pairs.interpolated, PosePairs::Side::estimate);
  ASSERT_EQ(pairs.size(), 3U);
  EXPECT_THAT(pairs.estimate[1], PoseNear(helix_at(4.27), 1e-9, 1e-9));
  EXPECT_THAT(pairs.reference[1], PoseNear(helix_at(4.27), 0.0, 1e-15));
  EXPECT_EQ(pairs.stamps_ns, reference.stamps_ns);
  EXPECT_EQ(pairs.estimate_idx[1], 42U);
  const PosePairs one = associate(helix({4.27}), helix(steps(0.0, 0.1, 100)), interpolating());
  EXPECT_EQ(one.interpolated, PosePairs::Side::estimate);
}

TEST(Interpolate, NothingIsInventedInGapsOrBeyondTheEnds) {
  const Trajectory reference = helix({0.0, 0.1, 0.2, 0.5, 0.6});
  const Trajectory estimate = helix({-0.01, 0.0, 0.15, 0.3, 0.5, 0.55, 0.61});
  const auto paired = [&](double max_gap) {
    return associate(reference, estimate, interpolating(max_gap)).estimate_idx;
  };
  using testing::ElementsAre;
  EXPECT_THAT(paired(0.25), ElementsAre(1U, 2U, 4U, 5U));
  EXPECT_THAT(paired(0.3), ElementsAre(1U, 2U, 3U, 4U, 5U));
  EXPECT_THAT(paired(0.1), ElementsAre(1U, 2U, 4U, 5U));
  EXPECT_THAT(paired(0.0), ElementsAre(1U, 4U));  // equal stamps are no gap
}

TEST(Interpolate, TheOffsetIsAddedToTheEstimate) {
  const Trajectory truth = helix(steps(0.0, 0.1, 20));
  Trajectory late = helix({0.53, 0.97});
  for (std::int64_t& stamp : late.stamps_ns) stamp -= 100'000'000'000;
  const PosePairs dense = associate(truth, late, interpolating(0.25, 100.0));
  ASSERT_EQ(dense.size(), 2U);
  EXPECT_THAT(dense.reference[0], PoseNear(helix_at(0.53), 1e-9, 1e-9));
  EXPECT_EQ(dense.stamps_ns[1], ns(0.97));
  const PosePairs sparse = associate(late, truth, interpolating(0.25, -100.0));
  ASSERT_EQ(sparse.size(), 2U);
  EXPECT_THAT(sparse.estimate[0], PoseNear(helix_at(0.53), 1e-9, 1e-9));
}

TEST(Interpolate, PositionsLieOnStraightLines) {
  Trajectory reference = helix({0.0, 0.2});
  reference.positions_only = true;
  for (Rigid3& pose : reference.poses) pose = Rigid3{};
  reference.poses[1].translation = {4.0, 8.0, -2.0};
  const PosePairs pairs = associate(reference, helix({0.05, 0.15}), interpolating());
  ASSERT_EQ(pairs.size(), 2U);
  EXPECT_TRUE(pairs.positions_only);
  EXPECT_LT((pairs.reference[0].translation - Eigen::Vector3d(1.0, 2.0, -0.5)).norm(), 1e-12);
}

TEST(Interpolate, PosesWithOneStampAreSteppedOver) {
  const Trajectory reference = helix({0.0, 0.1, 0.1, 0.2});
  const PosePairs pairs = associate(reference, helix({0.1, 0.15}), interpolating());
  ASSERT_EQ(pairs.size(), 2U);
  EXPECT_EQ(pairs.reference_idx[0], 1U);
  EXPECT_THAT(pairs.reference[1], PoseNear(helix_at(0.15), 1e-9, 1e-9));
}

TEST(Interpolate, ErrorsSayWhatIsMissing) {
  Trajectory plain;
  plain.poses.resize(2);
  EXPECT_THAT(error_of(helix({0.0, 0.1}), plain, interpolating()), HasSubstr("need stamps"));
  EXPECT_THAT(error_of(helix({0.0, 1.0}), helix({0.3, 0.6}), interpolating()),
              HasSubstr("raise the maximum gap"));
  EXPECT_THAT(error_of(helix({0.0, 0.1}), helix({5.0, 5.1}), interpolating()),
              HasSubstr("offset of -5.000"));
  EXPECT_THAT(error_of(helix({0.0}), helix({0.0}), interpolating(-1.0)), HasSubstr("maximum gap"));
  EXPECT_THAT(error_of(helix({0.0, 0.1}), helix({0.05}), {}), HasSubstr("interpolate"));
}

TEST(Interpolate, StampsAtTheEndOf64BitsTakeAnOffset) {
  constexpr std::int64_t end = std::numeric_limits<std::int64_t>::max();
  Trajectory reference = helix({0.0, 0.1, 0.2});
  reference.stamps_ns = {end - 200, end - 100, end};
  Trajectory estimate = helix({0.0, 0.1, 0.2});
  estimate.stamps_ns = {end - 150, end - 120, end - 50};
  EXPECT_EQ(associate(reference, estimate, interpolating()).size(), 3U);
  EXPECT_THAT(error_of(reference, estimate, interpolating(0.25, 4e9)), HasSubstr("not overlap"));
}

}  // namespace
}  // namespace kissmap
