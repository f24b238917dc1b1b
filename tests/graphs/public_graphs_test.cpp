// SPDX-License-Identifier: MIT
// Public pose graphs against the costs (chi2) that g2o (RainerKuemmerle/g2o, commit 34013227)
// reaches: gn_var_csparse until the cost stood still, from the start named.
#include <gtest/gtest.h>

#include <cstdlib>

#include "kissmap/formats/g2o.hpp"

namespace kissmap {
namespace {

struct PublicGraph {
  const char* name;
  std::size_t nodes;
  std::size_t edges;
  bool chordal;     ///< start; otherwise that of the file, or along a tree if it has none
  double g2o_cost;  ///< from the same start
};

void PrintTo(const PublicGraph& graph, std::ostream* os) {
  *os << graph.name;
}

class PublicGraphs : public testing::TestWithParam<PublicGraph> {};

TEST_P(PublicGraphs, CostIsThatOfG2o) {
  const char* data = std::getenv("KISSMAP_TEST_DATA");
  if (data == nullptr) GTEST_SKIP() << "KISSMAP_TEST_DATA is not set";
  const PublicGraph& expected = GetParam();
  GraphFile file =
      read_g2o(std::filesystem::path(data) / "graphs" / (std::string(expected.name) + ".g2o"),
               NegativeInformation::drop_coupling);
  EXPECT_EQ(file.ids.size(), expected.nodes);
  EXPECT_EQ(file.graph.edges.size(), expected.edges);
  if (expected.chordal) {
    file.graph.map_from_node = chordal_start(file.graph);
  } else if (!file.has_start) {
    file.graph.map_from_node = tree_start(file.graph);
  }
  PoseGraphOptions options;
  options.robust = false;
  const PoseGraphSolution solution = optimize(file.graph, options);
  EXPECT_TRUE(solution.converged);
  EXPECT_LE(solution.final_cost, 1.001 * expected.g2o_cost);
  EXPECT_GE(solution.final_cost, 0.999 * expected.g2o_cost) << "is the cost another one?";
}

INSTANTIATE_TEST_SUITE_P(,
                         PublicGraphs,
                         testing::Values(PublicGraph{"parking-garage", 1661, 6275, false, 1.238684},
                                         PublicGraph{"sphere2500", 2500, 4949, false, 727.149471},
                                         PublicGraph{"torus3D", 5000, 9048, true, 14574.746439},
                                         PublicGraph{"cubicle", 5750, 16869, true, 2379.908609},
                                         PublicGraph{"kitti_00", 4541, 4677, false, 98.322012}),
                         [](const auto& graph) {
                           std::string name = graph.param.name;
                           std::erase_if(name, [](char c) { return c == '-' || c == '_'; });
                           return name;
                         });

}  // namespace
}  // namespace kissmap
