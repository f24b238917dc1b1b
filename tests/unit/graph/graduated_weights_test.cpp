// SPDX-License-Identifier: MIT
#include "graph/graduated_weights.hpp"

#include <gtest/gtest.h>

#include "graph/edge_residual.hpp"
#include "support/loop_graph.hpp"

namespace kissmap {
namespace {

TEST(GraduatedWeights, QuantilesAreThoseOfTheTables) {
  EXPECT_NEAR(chi_square_quantile(0.95, 6), 12.592, 5e-4);
  EXPECT_NEAR(chi_square_quantile(0.999, 6), 22.458, 5e-4);
  EXPECT_NEAR(chi_square_quantile(0.95, 3), 7.815, 5e-4);
  EXPECT_NEAR(chi_square_quantile(0.999, 3), 16.266, 5e-4);
}

TEST(GraduatedWeights, FallFromOneToZeroAndSharpenWithMu) {
  const double bound = 20.0;
  for (const double mu : {1e-4, 0.1, 1.0, 50.0}) {
    double last = 1.0;
    for (double square = 0.0; square < 1e6; square = 1.1 * square + 0.1) {
      const double weight = graduated_weight(square, bound, mu);
      EXPECT_LE(weight, last);
      EXPECT_GE(weight, 0.0);
      last = weight;
    }
    EXPECT_EQ(graduated_weight(0.0, bound, mu), 1.0);
    EXPECT_EQ(graduated_weight(1e9, bound, mu), 0.0);
  }
  EXPECT_EQ(graduated_weight(0.99 * bound, bound, 1e6), 1.0);
  EXPECT_EQ(graduated_weight(1.01 * bound, bound, 1e6), 0.0);
}

TEST(GraduatedWeights, NothingIsRefusedAtTheFirstMu) {
  for (const double largest : {30.0, 1e3, 1e7}) {
    const double mu = first_mu(largest, 20.0);
    EXPECT_GT(graduated_weight(largest, 20.0, mu), 0.0);
  }
  EXPECT_TRUE(std::isinf(first_mu(19.0, 20.0)));
}

TEST(EdgeResidual, DerivativesAreThoseOfDifferences) {
  std::mt19937 random(1);
  for (const GraphSpace space : {GraphSpace::spatial, GraphSpace::planar}) {
    for (int i = 0; i < 50; ++i) {
      const Rigid3 from = random_pose(random, 10.0);
      const Rigid3 to = random_pose(random, 10.0);
      const Rigid3 measured = from.inverse() * to * noise(random, 0.5, 0.4);
      const EdgeResidual r = edge_residual(measured, from, to, space);
      EXPECT_EQ(r.error, edge_error(measured, from, to, space));
      for (int k = 0; k < 6; ++k) {
        const Twist step = 1e-6 * Twist::Unit(k);
        const Twist by_from = (edge_error(measured, stepped(from, step), to, space) -
                               edge_error(measured, stepped(from, -step), to, space)) /
                              2e-6;
        const Twist by_to = (edge_error(measured, from, stepped(to, step), space) -
                             edge_error(measured, from, stepped(to, -step), space)) /
                            2e-6;
        EXPECT_LT((by_from - r.by_from.col(k)).norm(), 1e-7);
        EXPECT_LT((by_to - r.by_to.col(k)).norm(), 1e-7);
      }
    }
  }
}

TEST(EdgeResidual, SquareRootSquaresToTheInformation) {
  Information information = information_of(0.1, 0.01);
  information(0, 5) = information(5, 0) = 300.0;
  EXPECT_TRUE((square_root(information).transpose() * square_root(information))
                  .isApprox(information, 1e-12));
  information = Information::Zero();
  information.topLeftCorner<3, 3>().setConstant(7.0);  // of rank one
  EXPECT_TRUE((square_root(information).transpose() * square_root(information))
                  .isApprox(information, 1e-12));
}

}  // namespace
}  // namespace kissmap
