// SPDX-License-Identifier: MIT
#pragma once

#include <vector>

#include "graph/edge_residual.hpp"

namespace kissmap {

struct LeastSquaresLimits {
  int max_iterations = 100;
  double min_cost_change = 1e-9;  ///< relative
};

struct LeastSquaresReport {
  int iterations = 0;
  bool converged = false;
};

/// Moves `poses` to a minimum of the sum of weight * |root * error|^2 over the edges of weight
/// above zero, by Levenberg-Marquardt. Whatever else is in graph.map_from_node is not looked at.
LeastSquaresReport minimise(const PoseGraph& graph,
                            const std::vector<Matrix6>& roots,
                            const std::vector<double>& weights,
                            const LeastSquaresLimits& limits,
                            std::vector<Rigid3>& poses);

}  // namespace kissmap
