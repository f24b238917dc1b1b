// SPDX-License-Identifier: MIT
#include "kissmap/formats/graph_edits.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>

#include "kissmap/error.hpp"
#include "support/matchers.hpp"
#include "support/temp_dir.hpp"

namespace kissmap {
namespace {

using testing::HasSubstr;

const std::vector<std::int64_t> ids{10, 20, 30};

PoseGraph triangle() {
  PoseGraph graph;
  graph.map_from_node.resize(3);
  graph.edges = {{0, 1, {}, Information::Identity(), EdgeKind::odometry},
                 {1, 2, {}, Information::Identity(), EdgeKind::odometry},
                 {0, 2, {}, Information::Identity(), EdgeKind::closure},
                 {2, 0, {}, Information::Identity(), EdgeKind::closure}};
  return graph;
}

class GraphEditsTest : public testing::Test {
 protected:
  PoseGraph edited(const std::string& text, PoseGraph graph = triangle()) const {
    std::ofstream(file_) << text;
    apply(read_graph_edits(file_), ids, graph);
    return graph;
  }
  GraphEdits read(const std::string& text) const {
    std::ofstream(file_) << text;
    return read_graph_edits(file_);
  }
  std::string file() const { return file_.string(); }
  std::string refusal(const std::string& text, const PoseGraph& graph = triangle()) const {
    try {
      edited(text, graph);
    } catch (const Error& error) {
      EXPECT_EQ(error.fault(), Fault::input);
      return error.what();
    }
    return "accepted";
  }

 private:
  TempDir temp_;
  std::filesystem::path file_ = temp_.path() / "edits.txt";
};

TEST_F(GraphEditsTest, NothingChangesNothing) {
  EXPECT_EQ(edited("").edges.size(), 4U);
  EXPECT_EQ(edited("# only\n\n   # remarks\r\n").edges.size(), 4U);
}

TEST_F(GraphEditsTest, RemoveTakesBothDirections) {
  EXPECT_EQ(edited("remove 10 30").edges.size(), 2U);
  EXPECT_EQ(edited("remove 30 10  # why\n").edges.size(), 2U);
}

TEST_F(GraphEditsTest, FixMakesTrusted) {
  for (const PoseGraphEdge& edge : edited("fix 30 10\n").edges) {
    EXPECT_EQ(edge.kind, EdgeKind::odometry);
  }
}

TEST_F(GraphEditsTest, AddAddsAClosure) {
  const PoseGraph graph = edited("add 30 20 1 2 3 0 0 1 0 0.5 0.02\nadd 10 30 1 2 3 0 0 0 1\n");
  ASSERT_EQ(graph.edges.size(), 6U);
  const PoseGraphEdge& edge = graph.edges[4];
  EXPECT_EQ(edge.from, 2U);
  EXPECT_EQ(edge.to, 1U);
  EXPECT_EQ(edge.kind, EdgeKind::closure);
  EXPECT_EQ(edge.from_from_to.translation, Eigen::Vector3d(1, 2, 3));
  EXPECT_NEAR(edge.from_from_to.angle(), 3.14159265358979, 1e-12);
  EXPECT_NEAR(edge.information(1, 1), 4.0, 1e-12);
  EXPECT_NEAR(edge.information(4, 4), 2500.0, 1e-9);
}

TEST_F(GraphEditsTest, EditsApplyInOrder) {
  const PoseGraph graph = edited("remove 10 30\nadd 10 30 0 0 0 0 0 0 1\nfix 10 30\n");
  ASSERT_EQ(graph.edges.size(), 3U);
  EXPECT_EQ(graph.edges.back().kind, EdgeKind::odometry);
  EXPECT_THAT(refusal("remove 10 30\nfix 10 30\n"), HasSubstr("edits.txt:2: there is no edge"));
}

TEST_F(GraphEditsTest, PosesMayBeMissingWhereTheyCanBeFound) {
  const std::string text =
      "add 30 20 # find it\nadd 10 30 near 1 2 3 0 0 0 1\nadd 1 2 1 2 3 0 0 0 1\n";
  const GraphEdits edits = read(text);
  EXPECT_EQ(edits.text, text);
  ASSERT_EQ(edits.edits.size(), 3U);
  EXPECT_FALSE(edits.edits[0].from_from_to);
  EXPECT_TRUE(edits.edits[1].is_guess);
  EXPECT_THAT(*edits.edits[1].from_from_to, PoseNear(Rigid3{{1, 0, 0, 0}, {1, 2, 3}}, 0.0, 0.0));
  EXPECT_FALSE(edits.edits[2].is_guess);
  EXPECT_EQ(edits.error(edits.edits[1], "so").what(), file() + ":2: so");
}

TEST_F(GraphEditsTest, MistakesAreErrorsWithTheirLine) {
  const std::vector<std::pair<std::string, std::string>> cases{
      {"\nmerge 10 20\n", "edits.txt:2: unknown edit 'merge'; known are remove, fix and add"},
      {"remove 10\n", ":1: TO is missing"},
      {"remove 10 10\n", ":1: FROM and TO are the same"},
      {"remove 10 -1\n", ":1: TO is '-1'"},
      {"remove 10 40\n", ":1: there is no node 40"},
      {"remove 10 20 30\n", ":1: unexpected '30'"},
      {"add 10 20 1 2 3\n", ":1: qx is missing"},
      {"add 10 20\n", ":1: only in a session"},
      {"add 10 20 near 1 2 3 0 0 0 1\n", ":1: only in a session"},
      {"add 10 20 near\n", ":1: x is missing"},
      {"add 10 20 far 1 2 3 0 0 0 1\n", ":1: x is 'far'"},
      {"add 10 20 near 1 2 3 0 0 0 1 0.1 0.1\n", ":1: unexpected '0.1 0.1'"},
      {"add 10 20 1 2 3 0 0 0 2\n", ":1: the quaternion"},
      {"add 10 20 1 2 3 0 0 0 1 0.5\n", ":1: sigma_rad is missing"},
      {"add 10 20 1 2 3 0 0 0 1 0 1\n", ":1: sigma_m is a standard deviation"},
      {"add 10 20 1 2 inf 0 0 0 1\n", ":1: z is 'inf'"}};
  for (const auto& [text, message] : cases) EXPECT_THAT(refusal(text), HasSubstr(message));
  PoseGraph planar = triangle();
  planar.space = GraphSpace::planar;
  EXPECT_THAT(refusal("add 10 30 1 2 3 0 0 0 1\n", planar), HasSubstr(":1: the graph is planar"));
  EXPECT_EQ(refusal("add 10 30 1 2 0 0 0 0 1\n", planar), "accepted");
}

}  // namespace
}  // namespace kissmap
