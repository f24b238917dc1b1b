// SPDX-License-Identifier: MIT
#include "kissmap/graph/pose_graph.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>

#include "kissmap/error.hpp"
#include "support/loop_graph.hpp"
#include "support/matchers.hpp"

namespace kissmap {
namespace {

using testing::Each;
using testing::HasSubstr;

PoseGraphOptions plain() {
  PoseGraphOptions options;
  options.robust = false;
  return options;
}

/// All start values but the fixed ones moved by some metres and tenths of a radian.
void shake(PoseGraph& graph, std::mt19937& random) {
  for (std::size_t i = 1; i < graph.map_from_node.size(); ++i) {
    graph.map_from_node[i] = graph.map_from_node[i] * noise(random, 2.0, 0.2);
  }
}

std::string refusal_of(const PoseGraph& graph) {
  try {
    optimize(graph, {});
  } catch (const Error& error) {
    EXPECT_EQ(error.fault(), Fault::input);
    return error.what();
  }
  return "accepted";
}

TEST(PoseGraph, ExactGraphRecoversTheTruth) {
  std::mt19937 random(1);
  LoopGraph loop = loop_graph(random, {.metres = 0.0, .radians = 0.0});
  shake(loop.graph, random);
  for (const bool robust : {false, true}) {
    PoseGraphOptions options;
    options.robust = robust;
    const PoseGraphSolution solution = optimize(loop.graph, options);
    EXPECT_TRUE(solution.converged);
    EXPECT_GT(solution.initial_cost, 1e3);
    EXPECT_LT(solution.final_cost, 1e-6);
    EXPECT_THAT(solution.edge_weights, Each(1.0));
    for (std::size_t i = 0; i < loop.truth.size(); ++i) {
      EXPECT_THAT(solution.map_from_node[i], PoseNear(loop.truth[i], 1e-6, 1e-6));
    }
  }
}

TEST(PoseGraph, CostIsThatOfTheDefinition) {
  // One edge, errors worked out by hand: 2 m beside, a quarter turn too far about z.
  PoseGraph graph;
  graph.map_from_node.resize(2);
  graph.map_from_node[1].translation = {3.0, 2.0, 0.0};
  graph.map_from_node[1].rotation =
      Eigen::AngleAxisd(std::numbers::pi / 2, Eigen::Vector3d::UnitZ());
  PoseGraphEdge edge{0, 1, {}, Information::Identity(), EdgeKind::odometry};
  edge.from_from_to.translation = {3.0, 0.0, 0.0};
  edge.information(1, 1) = 10.0;
  edge.information(5, 5) = 3.0;
  edge.information(1, 5) = edge.information(5, 1) = 0.5;
  graph.edges.push_back(edge);
  const double sine = 2.0 * std::sin(std::numbers::pi / 4);
  EXPECT_NEAR(cost(graph), 10.0 * 4.0 + 3.0 * sine * sine + 2.0 * 0.5 * 2.0 * sine, 1e-12);
  graph.space = GraphSpace::planar;
  const double angle = std::numbers::pi / 2;
  EXPECT_NEAR(cost(graph), 10.0 * 4.0 + 3.0 * angle * angle + 2.0 * 0.5 * 2.0 * angle, 1e-12);
}

TEST(PoseGraph, ResultIsAMinimum) {
  // Nothing near the result costs less: no derivative of ours is asked.
  std::mt19937 random(2);
  LoopGraph loop = loop_graph(random, {.nodes = 30, .radius = 20.0});
  PoseGraphOptions options = plain();
  options.min_cost_change = 1e-14;
  const PoseGraphSolution solution = optimize(loop.graph, options);
  for (const double size : {1e-2, 1e-3, 1e-4}) {
    for (int i = 0; i < 300; ++i) {
      loop.graph.map_from_node = solution.map_from_node;
      const auto node = static_cast<std::size_t>(1 + i % 29);
      loop.graph.map_from_node[node] = loop.graph.map_from_node[node] * noise(random, size, size);
      EXPECT_GE(cost(loop.graph), solution.final_cost * (1.0 - 1e-12));
    }
  }
}

TEST(PoseGraph, MovingTheGaugeMovesTheResultAsAWhole) {
  std::mt19937 random(3);
  LoopGraph loop = loop_graph(random);
  const PoseGraphSolution here = optimize(loop.graph, {});
  const Rigid3 there_from_here = random_pose(random, 1000.0);
  for (Rigid3& pose : loop.graph.map_from_node) pose = there_from_here * pose;
  const PoseGraphSolution there = optimize(loop.graph, {});
  EXPECT_NEAR(there.final_cost, here.final_cost, 1e-6 * here.final_cost);
  for (std::size_t i = 0; i < loop.truth.size(); ++i) {
    EXPECT_THAT(there.map_from_node[i],
                PoseNear(there_from_here * here.map_from_node[i], 1e-3, 1e-5));
  }
}

TEST(PoseGraph, FixedNodesStayToTheLastBit) {
  std::mt19937 random(4);
  LoopGraph loop = loop_graph(random);
  loop.graph.fixed = {0, 57, 133};
  loop.graph.map_from_node[57] = loop.truth[57];
  loop.graph.map_from_node[133] = loop.truth[133];
  const PoseGraphSolution solution = optimize(loop.graph, plain());
  for (const std::uint32_t node : loop.graph.fixed) {
    EXPECT_EQ(solution.map_from_node[node].matrix(), loop.graph.map_from_node[node].matrix());
  }
  EXPECT_LT(position_error(solution.map_from_node, loop.truth), 1.0);
}

TEST(PoseGraph, SameBitsEveryTime) {
  std::mt19937 random(5);
  LoopGraph loop = loop_graph(random);
  add_false_closures(loop, 0.2, random);
  const PoseGraphSolution first = optimize(loop.graph, {});
  const PoseGraphSolution second = optimize(loop.graph, {});
  EXPECT_EQ(first.final_cost, second.final_cost);
  for (std::size_t i = 0; i < loop.truth.size(); ++i) {
    EXPECT_EQ(first.map_from_node[i].matrix(), second.map_from_node[i].matrix());
  }
}

void expect_false_closures_refused(double growth) {
  for (unsigned seed = 0; seed < 10; ++seed) {
    std::mt19937 random(seed);
    LoopGraph loop = loop_graph(random);
    const double clean = position_error(optimize(loop.graph, plain()).map_from_node, loop.truth);
    add_false_closures(loop, 0.2, random);
    PoseGraphOptions trusting = plain();
    trusting.max_iterations = 10;
    const double fooled = position_error(optimize(loop.graph, trusting).map_from_node, loop.truth);
    PoseGraphOptions options;
    options.growth = growth;
    const PoseGraphSolution solution = optimize(loop.graph, options);
    int kept = 0;
    int closures = 0;
    for (std::size_t i = 0; i < loop.graph.edges.size(); ++i) {
      const bool is_closure = loop.graph.edges[i].kind == EdgeKind::closure;
      const double weight = solution.edge_weights[i];
      EXPECT_TRUE(weight == 0.0 || weight == 1.0) << weight;
      if (!is_closure || loop.is_false[i]) {
        EXPECT_EQ(weight, is_closure ? 0.0 : 1.0) << "seed " << seed << " edge " << i;
        continue;
      }
      ++closures;
      kept += weight == 1.0;
    }
    EXPECT_GE(kept, 0.95 * closures) << "seed " << seed;
    const double robust = position_error(solution.map_from_node, loop.truth);
    EXPECT_LT(robust, 1.05 * clean + 0.01) << "seed " << seed;
    EXPECT_GT(fooled, 5.0 * clean) << "the false closures do no harm: seed " << seed;
  }
}

TEST(PoseGraph, SurvivesFalseClosures) {
  expect_false_closures_refused(PoseGraphOptions{}.growth);
}

TEST(PoseGraph, SurvivesFalseClosuresInFewerSteps) {
  expect_false_closures_refused(2.0);
}

TEST(PoseGraph, PartsThatHangOnRefusedClosuresStay) {
  // Two trusted pairs, tied by two closures that contradict each other and a trusted rest.
  PoseGraph graph;
  graph.map_from_node.resize(4);
  for (int i = 0; i < 4; ++i) graph.map_from_node[i].translation.x() = i;
  Rigid3 step;
  step.translation.x() = 1.0;
  Rigid3 far = step;
  far.translation.y() = 1e3;
  Rigid3 farther = step;
  farther.translation.y() = -1e3;
  graph.edges = {{0, 1, step, Information::Identity(), EdgeKind::odometry},
                 {2, 3, step, Information::Identity(), EdgeKind::odometry},
                 {1, 2, far, Information::Identity(), EdgeKind::closure},
                 {1, 2, farther, Information::Identity(), EdgeKind::closure}};
  const PoseGraphSolution solution = optimize(graph, {});
  EXPECT_EQ(solution.edge_weights[2] + solution.edge_weights[3], 0.0);
  EXPECT_THAT(solution.map_from_node[2].inverse() * solution.map_from_node[3],
              PoseNear(step, 1e-6, 1e-6));
}

TEST(PoseGraph, NonsenseIsRefusedWithItsPlace) {
  std::mt19937 random(6);
  const PoseGraph good = loop_graph(random, {.nodes = 20}).graph;
  const double nan = std::numeric_limits<double>::quiet_NaN();
  PoseGraph graph = good;
  graph.edges[3].to = 20;
  EXPECT_THAT(refusal_of(graph), HasSubstr("edge 3 (3 to 20) leaves the graph of 20 nodes"));
  graph = good;
  graph.edges[3].to = 3;
  EXPECT_THAT(refusal_of(graph), HasSubstr("ties a node to itself"));
  graph = good;
  graph.edges[5].from_from_to.translation.x() = nan;
  EXPECT_THAT(refusal_of(graph), HasSubstr("edge 5"));
  graph = good;
  graph.edges[5].information(2, 2) = -1.0;
  EXPECT_THAT(refusal_of(graph), HasSubstr("information"));
  graph = good;
  graph.edges[5].information(2, 3) = 50.0;
  EXPECT_THAT(refusal_of(graph), HasSubstr("information"));
  graph = good;
  graph.map_from_node[7].rotation.coeffs().setZero();
  EXPECT_THAT(refusal_of(graph), HasSubstr("node 7"));
  graph = good;
  graph.fixed = {};
  EXPECT_THAT(refusal_of(graph), HasSubstr("no node is fixed"));
  graph = good;
  graph.fixed = {99};
  EXPECT_THAT(refusal_of(graph), HasSubstr("99"));
  graph = good;
  graph.map_from_node.emplace_back();
  EXPECT_THAT(refusal_of(graph), HasSubstr("node 20 is not tied to a fixed node"));
  graph.fixed.push_back(20);
  EXPECT_EQ(refusal_of(graph), "accepted");
  PoseGraphOptions options;
  options.max_iterations = 0;
  EXPECT_THROW(optimize(good, options), Error);
  options = {};
  options.growth = 1.0;  // would never end
  EXPECT_THROW(optimize(good, options), Error);
}

TEST(PoseGraph, SmallestGraphs) {
  EXPECT_TRUE(optimize(PoseGraph{}, {}).map_from_node.empty());
  PoseGraph one;
  one.map_from_node.resize(1);
  EXPECT_EQ(optimize(one, {}).final_cost, 0.0);
  EXPECT_TRUE(optimize(one, {}).converged);
}

TEST(PoseGraph, StartsOfAnExactGraphAreTheTruth) {
  std::mt19937 random(7);
  LoopGraph loop = loop_graph(random, {.metres = 0.0, .radians = 0.0});
  shake(loop.graph, random);
  for (const std::vector<Rigid3>& start : {chordal_start(loop.graph), tree_start(loop.graph)}) {
    for (std::size_t i = 0; i < loop.truth.size(); ++i) {
      EXPECT_THAT(start[i], PoseNear(loop.truth[i], 1e-6, 1e-6));
    }
  }
}

TEST(PoseGraph, ChordalStartIsNearTheOptimumAndLooksAtNoStartValues) {
  std::mt19937 random(8);
  LoopGraph loop = loop_graph(random);
  const double best = optimize(loop.graph, plain()).final_cost;
  const std::vector<Rigid3> start = chordal_start(loop.graph);
  shake(loop.graph, random);
  const std::vector<Rigid3> again = chordal_start(loop.graph);
  for (std::size_t i = 0; i < start.size(); ++i) EXPECT_EQ(start[i].matrix(), again[i].matrix());
  loop.graph.map_from_node = start;
  EXPECT_LT(cost(loop.graph), 5.0 * best);
}

TEST(PoseGraph, TreePrefersOdometry) {
  std::mt19937 random(9);
  LoopGraph loop = loop_graph(random);
  std::ranges::reverse(loop.graph.edges);
  const std::vector<Rigid3> start = tree_start(loop.graph);
  for (const PoseGraphEdge& edge : loop.graph.edges) {
    if (edge.kind == EdgeKind::closure) continue;
    EXPECT_THAT(start[edge.from].inverse() * start[edge.to],
                PoseNear(edge.from_from_to, 1e-9, 1e-9));
  }
}

}  // namespace
}  // namespace kissmap
