// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <vector>

#include "kissmap/graph/pose_graph.hpp"

namespace kissmap {

/// Sets of nodes that are joined step by step.
class Components {
 public:
  explicit Components(std::size_t nodes);

  /// False if a and b were in one set before.
  bool join(std::uint32_t a, std::uint32_t b);
  std::uint32_t root(std::uint32_t node);  ///< the smallest node of the set

 private:
  std::vector<std::uint32_t> parent_;
};

/// Throws what optimize() promises to throw.
void require_valid(const PoseGraph& graph);

/// The fixed nodes, and the first node of each part of the graph that no edge of weight above zero
/// ties to one: what must be held for a unique solution. Ascending.
std::vector<std::uint32_t> held_nodes(const PoseGraph& graph, const std::vector<double>& weights);

}  // namespace kissmap
