// SPDX-License-Identifier: MIT
#include "kissmap/loop_closing/planar_alignment.hpp"

#include <gtest/gtest.h>

#include <numbers>
#include <random>
#include <vector>

namespace kissmap {
namespace {

std::vector<PlanarPair> pairs_under(const Rigid2& motion, int count, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<float> place(-40.0F, 40.0F);
  std::vector<PlanarPair> pairs;
  for (int i = 0; i < count; ++i) {
    const Eigen::Vector2f query(place(random), place(random));
    pairs.push_back({query, (motion * query.cast<double>()).cast<float>()});
  }
  return pairs;
}

void add_false_pairs(std::vector<PlanarPair>& pairs, int count) {
  std::mt19937_64 random(7);
  std::uniform_real_distribution<float> place(-40.0F, 40.0F);
  for (int i = 0; i < count; ++i) {
    pairs.push_back({{place(random), place(random)}, {place(random), place(random)}});
  }
}

class AnyAngle : public testing::TestWithParam<double> {};

TEST_P(AnyAngle, FitIsExactForExactPairs) {
  const Rigid2 motion{GetParam(), {3.0, -8.0}};
  const Rigid2 fit = fit_planar(pairs_under(motion, 12, 1));
  EXPECT_NEAR(std::remainder(fit.angle - motion.angle, 2.0 * std::numbers::pi), 0.0, 1e-6);
  EXPECT_LT((fit.translation - motion.translation).norm(), 1e-4);
}

TEST_P(AnyAngle, FindsTheMotionAmongFourTimesAsManyFalsePairs) {
  const Rigid2 motion{GetParam(), {-15.0, 6.0}};
  std::vector<PlanarPair> pairs = pairs_under(motion, 15, 2);
  add_false_pairs(pairs, 60);
  const auto alignment = align_planar(pairs, 1.0, 3);
  ASSERT_TRUE(alignment);
  EXPECT_GE(alignment->inliers, 15);
  EXPECT_NEAR(
      std::remainder(alignment->reference_from_query.angle - motion.angle, 2.0 * std::numbers::pi),
      0.0,
      0.02);
  EXPECT_LT((alignment->reference_from_query.translation - motion.translation).norm(), 0.5);
}

INSTANTIATE_TEST_SUITE_P(Turns, AnyAngle, testing::Values(0.0, 0.3, 1.5707963, 2.9, 3.1, -2.0));

TEST(PlanarAlignment, NeverTakesAMirrorImageForAMotion) {
  std::vector<PlanarPair> pairs = pairs_under({0.4, {2.0, 1.0}}, 40, 5);
  for (PlanarPair& pair : pairs) pair.reference.x() *= -1.0F;
  const auto alignment = align_planar(pairs, 0.5, 1);
  // Under a rotation some pairs of a mirror image come near by chance, most cannot.
  EXPECT_LT(alignment ? alignment->inliers : 0, 10);
}

TEST(PlanarAlignment, SameSeedSameAnswer) {
  std::vector<PlanarPair> pairs = pairs_under({1.0, {2.0, 1.0}}, 6, 8);
  add_false_pairs(pairs, 40);
  const auto first = align_planar(pairs, 1.0, 11);
  const auto second = align_planar(pairs, 1.0, 11);
  ASSERT_TRUE(first && second);
  EXPECT_EQ(first->inliers, second->inliers);
  EXPECT_EQ(first->reference_from_query.angle, second->reference_from_query.angle);
  EXPECT_EQ(first->reference_from_query.translation, second->reference_from_query.translation);
}

TEST(PlanarAlignment, NeedsTwoPairsApart) {
  EXPECT_FALSE(align_planar({}, 1.0, 0));
  const std::vector<PlanarPair> one(5, PlanarPair{{1.0F, 2.0F}, {3.0F, 4.0F}});
  EXPECT_FALSE(align_planar(one, 1.0, 0)) << "five times the same pair leaves the angle open";
}

}  // namespace
}  // namespace kissmap
