// SPDX-License-Identifier: MIT
#include "graph/components.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <numeric>
#include <set>
#include <string>

#include "kissmap/error.hpp"

namespace kissmap {
namespace {

[[noreturn]] void fail(const std::string& message) {
  throw Error(Fault::input, "pose graph: " + message);
}

bool is_pose(const Rigid3& pose) {
  return pose.translation.allFinite() && pose.rotation.coeffs().allFinite() &&
         std::abs(pose.rotation.norm() - 1.0) < 1e-6;
}

bool is_planar(const Rigid3& pose) {
  return pose.translation.z() == 0.0 && pose.rotation.x() == 0.0 && pose.rotation.y() == 0.0;
}

bool is_information(const Information& information) {
  if (!information.allFinite()) return false;
  const double size = information.cwiseAbs().maxCoeff();
  if ((information - information.transpose()).cwiseAbs().maxCoeff() > 1e-9 * size) return false;
  const Eigen::SelfAdjointEigenSolver<Information> eigen(information, Eigen::EigenvaluesOnly);
  return eigen.info() == Eigen::Success && eigen.eigenvalues().minCoeff() >= -1e-9 * size;
}

void require_edge(const PoseGraphEdge& edge, std::size_t index, const PoseGraph& graph) {
  const std::size_t nodes = graph.map_from_node.size();
  const std::string name = "edge " + std::to_string(index) + " (" + std::to_string(edge.from) +
                           " to " + std::to_string(edge.to) + ") ";
  if (edge.from >= nodes || edge.to >= nodes) {
    fail(name + "leaves the graph of " + std::to_string(nodes) + " nodes");
  }
  if (edge.from == edge.to) fail(name + "ties a node to itself");
  if (!is_pose(edge.from_from_to)) fail(name + "has a pose that is not finite or not rigid");
  if (!is_information(edge.information)) {
    fail(name + "has an information matrix that is not finite, symmetric and positive");
  }
  if (graph.space == GraphSpace::planar && !is_planar(edge.from_from_to)) {
    fail(name + "leaves the plane of a planar graph");
  }
}

Components joined_to_fixed(const PoseGraph& graph, const std::vector<double>& weights) {
  Components components(graph.map_from_node.size());
  for (const std::uint32_t node : graph.fixed) components.join(graph.fixed.front(), node);
  for (std::size_t i = 0; i < graph.edges.size(); ++i) {
    if (weights[i] > 0.0) components.join(graph.edges[i].from, graph.edges[i].to);
  }
  return components;
}

}  // namespace

Components::Components(std::size_t nodes) : parent_(nodes) {
  std::iota(parent_.begin(), parent_.end(), 0U);
}

std::uint32_t Components::root(std::uint32_t node) {
  while (parent_[node] != node) {
    parent_[node] = parent_[parent_[node]];
    node = parent_[node];
  }
  return node;
}

bool Components::join(std::uint32_t a, std::uint32_t b) {
  const auto [low, high] = std::minmax({root(a), root(b)});
  parent_[high] = low;
  return low != high;
}

void require_valid(const PoseGraph& graph) {
  const std::size_t nodes = graph.map_from_node.size();
  for (std::size_t i = 0; i < nodes; ++i) {
    const Rigid3& pose = graph.map_from_node[i];
    const std::string name = "node " + std::to_string(i) + " ";
    if (!is_pose(pose)) fail(name + "has a pose that is not finite or not rigid");
    if (graph.space == GraphSpace::planar && !is_planar(pose)) {
      fail(name + "leaves the plane of a planar graph");
    }
  }
  for (std::size_t i = 0; i < graph.edges.size(); ++i) require_edge(graph.edges[i], i, graph);
  for (const std::uint32_t node : graph.fixed) {
    if (node < nodes) continue;
    if (nodes == 0 && graph.fixed.size() == 1) continue;  // an empty graph needs no gauge
    fail("fixed node " + std::to_string(node) + " is not one of its " + std::to_string(nodes));
  }
  if (nodes == 0) return;
  if (graph.fixed.empty()) fail("no node is fixed");
  Components components = joined_to_fixed(graph, std::vector(graph.edges.size(), 1.0));
  const std::uint32_t anchor = components.root(graph.fixed.front());
  for (std::uint32_t node = 0; node < nodes; ++node) {
    if (components.root(node) == anchor) continue;
    fail("node " + std::to_string(node) +
         " is not tied to a fixed node by any chain of edges; add an edge or fix it");
  }
}

std::vector<std::uint32_t> held_nodes(const PoseGraph& graph, const std::vector<double>& weights) {
  Components components = joined_to_fixed(graph, weights);
  std::set<std::uint32_t> held(graph.fixed.begin(), graph.fixed.end());
  const std::uint32_t anchor = components.root(graph.fixed.front());
  for (std::uint32_t node = 0; node < graph.map_from_node.size(); ++node) {
    const std::uint32_t root = components.root(node);
    if (root != anchor) held.insert(root);
  }
  return {held.begin(), held.end()};
}

}  // namespace kissmap
