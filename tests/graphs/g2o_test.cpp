// SPDX-License-Identifier: MIT
#include "kissmap/formats/g2o.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "kissmap/error.hpp"
#include "support/loop_graph.hpp"
#include "support/matchers.hpp"
#include "support/program.hpp"
#include "support/temp_dir.hpp"

namespace kissmap {
namespace {

using testing::HasSubstr;
using testing::StartsWith;

const std::string unit3 = " 1 0 0 1 0 1\n";
const std::string unit6 = " 1 0 0 0 0 0 1 0 0 0 0 1 0 0 0 1 0 0 1 0 1\n";

class G2o : public testing::Test {
 protected:
  std::filesystem::path path(const std::string& name = "graph.g2o") const {
    return temp_.path() / name;
  }
  GraphFile read(const std::string& text,
                 NegativeInformation negative = NegativeInformation::refuse) const {
    std::ofstream(path(), std::ios::binary) << text;
    return read_g2o(path(), negative);
  }
  /// The message without the folder; empty if the text was accepted.
  std::string refusal(const std::string& text) const {
    try {
      read(text);
    } catch (const Error& error) {
      EXPECT_EQ(error.fault(), Fault::input);
      return std::string(error.what()).substr(temp_.path().string().size() + 1);
    }
    return "";
  }

 private:
  TempDir temp_;
};

TEST_F(G2o, ReadsAHandWrittenFile) {
  const GraphFile file = read(
      "# a comment\n"
      "VERTEX_SE3:QUAT 7 1 2 3 0 0 0 1\r\n"
      "\n"
      "VERTEX_SE3:QUAT 3 0 0 0 0 0 0.70710678118654752 0.70710678118654752 \n"
      "VERTEX_CAM 1 2 3\n"
      "FIX 7\n"
      "EDGE_SE3:QUAT 3 7 1 0 0 0 0 0 1 2 0 0 8 0 0 2 0 0 0 0 2 0 0 0 40 0 0 40 0 400\n"
      "VERTEX_CAM 1 2 3");
  EXPECT_EQ(file.ids, (std::vector<std::int64_t>{3, 7}));
  EXPECT_TRUE(file.has_start);
  EXPECT_EQ(file.graph.fixed, std::vector<std::uint32_t>{1});
  EXPECT_EQ(file.graph.map_from_node[1].translation, Eigen::Vector3d(1, 2, 3));
  EXPECT_NEAR(file.graph.map_from_node[0].angle(), std::numbers::pi / 2, 1e-12);
  EXPECT_EQ(file.skipped, (std::map<std::string, std::uint64_t>{{"VERTEX_CAM", 2}}));
  ASSERT_EQ(file.graph.edges.size(), 1U);
  const PoseGraphEdge& edge = file.graph.edges.front();
  EXPECT_EQ(edge.from, 0U);
  EXPECT_EQ(edge.to, 1U);
  EXPECT_EQ(edge.kind, EdgeKind::closure);
  // Vector parts of quaternions are half of rotation vectors.
  EXPECT_EQ(edge.information(0, 0), 2.0);
  EXPECT_EQ(edge.information(0, 3), 4.0);
  EXPECT_EQ(edge.information(3, 0), 4.0);
  EXPECT_EQ(edge.information(3, 3), 10.0);
  EXPECT_EQ(edge.information(5, 5), 100.0);
}

TEST_F(G2o, NodesOfAFileWithoutVerticesAreThoseOfItsEdges) {
  const GraphFile file = read("EDGE_SE2 10 11 1 0 0" + unit3 + "EDGE_SE2 11 2 1 0 0.5" + unit3);
  EXPECT_EQ(file.ids, (std::vector<std::int64_t>{2, 10, 11}));
  EXPECT_FALSE(file.has_start);
  EXPECT_EQ(file.graph.space, GraphSpace::planar);
  EXPECT_EQ(file.graph.fixed, std::vector<std::uint32_t>{0});
  EXPECT_EQ(file.graph.edges[0].kind, EdgeKind::odometry);
  EXPECT_EQ(file.graph.edges[1].kind, EdgeKind::closure);
  EXPECT_NEAR(file.graph.edges[1].from_from_to.angle(), 0.5, 1e-15);
}

TEST_F(G2o, WhatIsWrittenReadsBackToTheLastBit) {
  std::mt19937 random(1);
  GraphFile file;
  LoopGraph loop = loop_graph(random);
  file.graph = loop.graph;
  file.graph.fixed = {3, 11};
  std::normal_distribution<double> normal;
  for (PoseGraphEdge& edge : file.graph.edges) {
    Information a;
    for (double& value : a.reshaped()) value = normal(random);
    edge.information = a * a.transpose();
    edge.information = 0.5 * (edge.information + Information(edge.information.transpose()));
  }
  for (std::size_t i = 0; i < loop.truth.size(); ++i) {
    file.ids.push_back(static_cast<std::int64_t>(i) + 5'000'000'000);
  }
  write_g2o(file, path());
  const GraphFile back = read_g2o(path());
  EXPECT_EQ(back.ids, file.ids);
  EXPECT_EQ(back.graph.fixed, file.graph.fixed);
  ASSERT_EQ(back.graph.edges.size(), file.graph.edges.size());
  for (std::size_t i = 0; i < file.ids.size(); ++i) {
    EXPECT_THAT(back.graph.map_from_node[i], PoseNear(file.graph.map_from_node[i], 0.0, 1e-15));
  }
  for (std::size_t i = 0; i < file.graph.edges.size(); ++i) {
    EXPECT_EQ(back.graph.edges[i].information, file.graph.edges[i].information);
    EXPECT_EQ(back.graph.edges[i].kind, file.graph.edges[i].kind);
  }
  write_g2o(back, path("again.g2o"));
  EXPECT_EQ(file_text(path("again.g2o")), file_text(path()));
}

TEST_F(G2o, PlanarGraphsStayPlanarThroughOptimisation) {
  GraphFile file = read("EDGE_SE2 0 1 1 0 1.5" + unit3 + "EDGE_SE2 1 2 1 0 1.5" + unit3 +
                        "EDGE_SE2 2 0 1.1 0.2 -2.9" + unit3);
  file.graph.map_from_node = tree_start(file.graph);
  const PoseGraphSolution solution = optimize(file.graph, {});
  EXPECT_LT(solution.final_cost, 0.9 * solution.initial_cost);
  file.graph.map_from_node = solution.map_from_node;
  write_g2o(file, path());
  EXPECT_THAT(file_text(path()), StartsWith("VERTEX_SE2 0 0 0 0\nVERTEX_SE2 1 "));
  const GraphFile back = read_g2o(path());
  EXPECT_NEAR(cost(back.graph), solution.final_cost, 1e-12);
}

TEST_F(G2o, RefusedEdgesAreKeptAsComments) {
  GraphFile file = read("EDGE_SE2 0 1 1 0 0" + unit3 + "EDGE_SE2 0 1 9 9 1" + unit3);
  write_g2o(file, path(), {1.0, 0.0});
  EXPECT_THAT(file_text(path()), HasSubstr("\n# refused EDGE_SE2 0 1 9 9 1 1 0 0 1 0 1\n"));
  EXPECT_EQ(read_g2o(path()).graph.edges.size(), 1U);
}

TEST_F(G2o, NegativeInformationIsRefusedOrLosesItsCoupling) {
  const std::string line =
      "EDGE_SE3:QUAT 0 1 0 0 0 0 0 0 1 1 0 0 0 9 0 1 0 0 0 0 1 0 0 0 1 0 0 1 0 1\n";
  EXPECT_THAT(refusal(line), StartsWith("graph.g2o:1: the information is negative"));
  const GraphFile file = read(line, NegativeInformation::drop_coupling);
  EXPECT_EQ(file.couplings_dropped, 1U);
  EXPECT_EQ(file.graph.edges[0].information(0, 4), 0.0);
  EXPECT_EQ(file.graph.edges[0].information(4, 4), 0.25);
}

TEST_F(G2o, DamagedFilesAreErrorsWithTheirLine) {
  const std::string good = "VERTEX_SE3:QUAT 0 0 0 0 0 0 0 1\nVERTEX_SE3:QUAT 1 0 0 0 0 0 0 1\n";
  const std::string edge = "EDGE_SE3:QUAT 0 1 1 0 0 0 0 0 1";
  EXPECT_EQ(refusal(good + edge + unit6), "");
  const std::vector<std::pair<std::string, std::string>> cases{
      {"", "holds no vertex"},
      {std::string(1000, '\0'), "holds no vertex"},
      {"FIX 0\n", "holds no vertex"},
      {good + "VERTEX_SE3:QUAT 1 0 0 0 0 0 0 1\n", ":3: vertex 1 is there twice"},
      {good + "VERTEX_SE3:QUAT 2 0 0\n", ":3: z is missing"},
      {good + "VERTEX_SE3:QUAT 2 0 0 nan 0 0 0 1\n", ":3: z is 'nan', not a finite number"},
      {good + "VERTEX_SE3:QUAT 2 0 0 1e999 0 0 0 1\n", ":3: z is '1e999'"},
      {good + "VERTEX_SE3:QUAT 2 0 0 1,5 0 0 0 1\n", ":3: z is '1,5'"},
      {good + "VERTEX_SE3:QUAT 2 0 0 0 0 0 0 0\n", ":3: the quaternion"},
      {good + "VERTEX_SE3:QUAT 2 0 0 0 1e200 0 0 1\n", ":3: the quaternion"},
      {good + "VERTEX_SE3:QUAT -2 0 0 0 0 0 0 1\n", ":3: id is '-2'"},
      {good + "VERTEX_SE3:QUAT 99999999999999999999 0 0 0 0 0 0 1\n", ":3: id is"},
      {good + "VERTEX_SE3:QUAT 2 0 0 0 0 0 0 1 5\n", ":3: unexpected '5'"},
      {good + "VERTEX_SE2 2 0 0 0\n", ":3: SE2 and SE3"},
      {good + edge + " 1 0 0\n", ":3: information is missing"},
      {good + edge + " inf" + unit6.substr(2), ":3: information is 'inf'"},
      {good + edge + " -1" + unit6.substr(2), ":3: the information is negative"},
      {good + "EDGE_SE3:QUAT 0 2 1 0 0 0 0 0 1" + unit6, ":3: there is no vertex 2"},
      {good + "EDGE_SE3:QUAT 1 1 1 0 0 0 0 0 1" + unit6, ":3: an edge from a vertex to itself"},
      {good + "FIX 9\n", ":3: there is no vertex 9"},
      {good + "FIX\n", ":3: id is missing"}};
  for (const auto& [text, message] : cases) {
    EXPECT_THAT(refusal(text), HasSubstr(message)) << text;
  }
  EXPECT_THROW(read_g2o(path("absent.g2o")), Error);
  EXPECT_THROW(read_g2o(path("")), Error);
}

TEST_F(G2o, AnyCutOfAFileIsAnErrorOrASmallerGraph) {
  std::string text =
      "EDGE_SE3:QUAT 0 1 1.5 0 0 0 0 0 1" + unit6 + "EDGE_SE3:QUAT 1 2 1 0 0 0 0 0 1" + unit6;
  for (std::size_t length = 0; length < text.size(); ++length) {
    try {
      EXPECT_LE(read(text.substr(0, length)).graph.edges.size(), 2U);
    } catch (const Error& error) {
      EXPECT_EQ(error.fault(), Fault::input);
    }
  }
}

}  // namespace
}  // namespace kissmap
