// SPDX-License-Identifier: MIT
#include "kissmap/geometry/rigid3.hpp"

#include <gtest/gtest.h>

#include <numbers>
#include <random>

#include "support/matchers.hpp"

namespace kissmap {
namespace {

Twist random_twist(std::mt19937& random, double max_angle) {
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  Twist twist;
  for (double& value : twist) value = unit(random);
  twist.head<3>() *= 50.0;
  twist.tail<3>() *= max_angle / twist.tail<3>().norm();
  return twist;
}

TEST(Rigid3, ComposesLikeMatrices) {
  std::mt19937 random(1);
  for (int i = 0; i < 100; ++i) {
    const Rigid3 a_from_b = exp(random_twist(random, 3.0));
    const Rigid3 b_from_c = exp(random_twist(random, 2.0));
    EXPECT_TRUE(
        (a_from_b * b_from_c).matrix().isApprox(a_from_b.matrix() * b_from_c.matrix(), 1e-12));
  }
}

TEST(Rigid3, InverseUndoes) {
  std::mt19937 random(2);
  const Rigid3 a_from_b = exp(random_twist(random, 2.5));
  EXPECT_THAT(a_from_b * a_from_b.inverse(), PoseNear(Rigid3{}, 1e-12, 1e-12));
}

TEST(Rigid3, ExpUndoesLogFromTinyToAlmostHalfTurns) {
  std::mt19937 random(3);
  for (const double angle : {0.0, 1e-12, 1e-7, 9e-5, 1.1e-4, 0.1, 1.5, 3.1, 3.1415926}) {
    Twist twist = random_twist(random, 1.0);
    twist.tail<3>() *= angle;
    EXPECT_TRUE(log(exp(twist)).isApprox(twist, 1e-8)) << "angle " << angle;
  }
}

TEST(Rigid3, HalfMotionTwiceIsTheMotion) {
  std::mt19937 random(4);
  const Rigid3 motion = exp(random_twist(random, 1.2));
  const Rigid3 half = exp(0.5 * log(motion));
  EXPECT_THAT(half * half, PoseNear(motion, 1e-10, 1e-12));
}

TEST(Rigid3, ScrewMotionMatchesClosedForm) {
  // A quarter turn about z while moving along x in the body frame is an arc of radius 2 v / pi.
  Twist twist = Twist::Zero();
  twist(0) = 1.0;
  twist(5) = std::numbers::pi / 2;
  const double radius = 2.0 / std::numbers::pi;
  EXPECT_TRUE(exp(twist).translation.isApprox(Eigen::Vector3d(radius, radius, 0.0), 1e-12));
}

TEST(Rigid3, FromMatrixRepairsRoundedRotations) {
  std::mt19937 random(5);
  const Rigid3 expected = exp(random_twist(random, 2.0));
  Eigen::Matrix<double, 3, 4> rounded = expected.matrix().topRows<3>();
  rounded = (rounded * 1e5).array().round() / 1e5;
  const Rigid3 read = Rigid3::from_matrix(rounded);
  EXPECT_NEAR(read.rotation.norm(), 1.0, 1e-15);
  EXPECT_THAT(read, PoseNear(expected, 2e-5, 2e-5));
}

TEST(Rigid3, AngleIsThatOfTheShorterRotation) {
  Rigid3 turn;
  turn.rotation = Eigen::AngleAxisd(0.3, Eigen::Vector3d::UnitZ());
  turn.rotation.coeffs() *= -1.0;
  EXPECT_NEAR(turn.angle(), 0.3, 1e-12);
}

}  // namespace
}  // namespace kissmap
