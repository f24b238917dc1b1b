// SPDX-License-Identifier: MIT
#include "kissmap/loop_closing/closure_validation.hpp"

#include <gtest/gtest.h>

#include "support/block_world.hpp"
#include "support/matchers.hpp"

namespace kissmap {
namespace {

/// A bare corridor along x: two walls and a floor, without doors.
std::vector<Eigen::Vector3f> corridor(float from, float to) {
  std::vector<Eigen::Vector3f> points;
  for (float x = from; x < to; x += 0.17F) {
    for (float s = 0.03F; s < 2.5F; s += 0.17F) {
      points.emplace_back(x, -0.93F, s);
      points.emplace_back(x, 1.21F, s);
      if (s < 2.1F) points.emplace_back(x, s - 0.93F, 0.03F);
    }
  }
  return points;
}

TEST(SurfelRegistration, RecoversAKnownMotion) {
  const auto world = block_world(2);
  const SurfelReference reference(surfels_of(world), 0.5);
  for (const double yaw : {0.0, 40.0, 175.0}) {
    const Rigid3 reference_from_query = planar_motion(5.0, -3.0, yaw);
    const SurfelCloud query = surfels_of(moved(reference_from_query.inverse(), world));
    const Rigid3 guess = reference_from_query * planar_motion(0.7, -0.5, 2.0);
    const SurfelAlignment alignment = register_surfels(query, reference, guess);
    EXPECT_TRUE(alignment.converged);
    EXPECT_THAT(alignment.reference_from_query, PoseNear(reference_from_query, 0.05, 0.002));
    EXPECT_LT(alignment.residual_after, alignment.residual_before);
  }
}

TEST(SurfelRegistration, SaysWhenItHasNothingToHoldOn) {
  const SurfelReference reference(surfels_of(block_world(2)), 0.5);
  EXPECT_FALSE(register_surfels(SurfelCloud{}, reference, Rigid3{}).converged);
  Rigid3 far_away;
  far_away.translation.x() = 1000.0;
  EXPECT_FALSE(register_surfels(surfels_of(block_world(3)), reference, far_away).converged);
}

TEST(Overlap, IsOneForTheSameMapAndNoneApart) {
  const SurfelCloud surfels = surfels_of(block_world(4));
  const SurfelMap map(surfels, 0.5);
  EXPECT_EQ(overlap(surfels, map, Rigid3{}), 1.0);
  Rigid3 apart;
  apart.translation.x() = 500.0;
  EXPECT_EQ(overlap(surfels, map, apart), 0.0);
  EXPECT_EQ(overlap(SurfelCloud{}, map, Rigid3{}), 0.0);
}

TEST(Overlap, CountsTheSmallerMap) {
  const auto world = block_world(5);
  std::vector<Eigen::Vector3f> part;
  std::ranges::copy_if(
      world, std::back_inserter(part), [](const Eigen::Vector3f& p) { return p.x() > 0.0F; });
  EXPECT_GT(overlap(surfels_of(part), SurfelMap(surfels_of(world), 0.5), Rigid3{}), 0.98);
  EXPECT_GT(overlap(surfels_of(world), SurfelMap(surfels_of(part), 0.5), Rigid3{}), 0.98);
}

TEST(ClosureValidation, AcceptsTheTruePlace) {
  const auto world = block_world(6);
  const Rigid3 truth = planar_motion(-6.0, 2.0, 100.0);
  const Closure closure = validate_closure(surfels_of(moved(truth.inverse(), world)),
                                           SurfelReference(surfels_of(world), 0.5),
                                           truth * planar_motion(0.4, 0.3, 1.0),
                                           {});
  EXPECT_EQ(closure.verdict, ClosureVerdict::accepted);
  EXPECT_THAT(closure.reference_from_query, PoseNear(truth, 0.05, 0.002));
  EXPECT_GT(closure.wall_agreement, 0.7);
  // A closure that is sure of itself: symmetric, positive information.
  EXPECT_EQ(closure.information, closure.information.transpose());
  EXPECT_EQ(closure.information.llt().info(), Eigen::Success);
}

TEST(ClosureValidation, RefusesAnotherPlaceWhoseGroundFits) {
  const Closure closure = validate_closure(
      surfels_of(block_world(7)), SurfelReference(surfels_of(block_world(8)), 0.5), Rigid3{}, {});
  EXPECT_NE(closure.verdict, ClosureVerdict::accepted);
}

TEST(ClosureValidation, RefusesACorridorThatLooksTheSameEverywhere) {
  const Rigid3 somewhere = Rigid3{Eigen::Quaterniond::Identity(), {7.0, 0.0, 0.0}};
  const Closure closure =
      validate_closure(surfels_of(corridor(-20.0F, 20.0F)),
                       SurfelReference(surfels_of(corridor(-30.0F, 30.0F)), 0.5),
                       somewhere,
                       {});
  EXPECT_EQ(closure.verdict, ClosureVerdict::unobservable);
}

TEST(ClosureValidation, MeasuresAPoseWithoutChangingIt) {
  const auto world = block_world(6);
  const Rigid3 truth = planar_motion(-6.0, 2.0, 100.0);
  const SurfelCloud query = surfels_of(moved(truth.inverse(), world));
  const SurfelReference reference(surfels_of(world), 0.5);
  const Closure exact = measure_closure(query, reference, truth);
  EXPECT_THAT(exact.reference_from_query, PoseNear(truth, 0.0, 1e-12));
  EXPECT_EQ(exact.residual_before, exact.residual_after);
  const Closure off = measure_closure(query, reference, truth * planar_motion(0.5, 0.2, 1.0));
  EXPECT_GT(exact.overlap, off.overlap);
  EXPECT_GT(exact.wall_agreement, off.wall_agreement);
  EXPECT_LT(exact.residual_after, off.residual_after);
}

TEST(ClosureValidation, WhatDidNotComeToRestIsMeasuredToo) {
  const Rigid3 somewhere = Rigid3{Eigen::Quaterniond::Identity(), {7.0, 0.0, 0.0}};
  const SurfelCloud query = surfels_of(corridor(-20.0F, 20.0F));
  const SurfelReference reference(surfels_of(corridor(-30.0F, 30.0F)), 0.5);
  const Closure slid = validate_closure(query, reference, somewhere, {});
  const Closure again = measure_closure(query, reference, slid.reference_from_query);
  EXPECT_GT(slid.overlap, 0.0);
  EXPECT_EQ(slid.overlap, again.overlap);
  EXPECT_EQ(slid.center_in_query, again.center_in_query);
  EXPECT_EQ(slid.information, again.information);
}

TEST(ClosureInformation, CountsErrorsWhereTheLocalMapsMeet) {
  Closure closure;
  closure.center_in_query = {20.0, -7.0, 2.0};
  closure.sigmas = ClosureSigmas{0.3, 0.02};
  const Information information = information_of(closure);
  const Rigid3 query_from_center{Eigen::Quaterniond::Identity(), closure.center_in_query};
  for (int axis = 0; axis < 6; ++axis) {
    Twist at_center = Twist::Zero();
    at_center(axis) = 1e-5;
    const Twist at_keypose = log(query_from_center * exp(at_center) * query_from_center.inverse());
    const double sigma = axis < 3 ? 0.3 : 0.02;
    EXPECT_NEAR(at_keypose.dot(information * at_keypose) * sigma * sigma / 1e-10, 1.0, 1e-6);
  }
}

}  // namespace
}  // namespace kissmap
