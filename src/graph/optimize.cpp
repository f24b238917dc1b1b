// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cmath>

#include "graph/components.hpp"
#include "graph/graduated_weights.hpp"
#include "graph/least_squares.hpp"
#include "kissmap/graph/pose_graph.hpp"
#include "options.hpp"

namespace kissmap {
namespace {

constexpr double fast_growth = 5.0;  // while mu is so small that weights fall as 1 / error anyway
constexpr double small_mu = 0.05;
constexpr int first_iterations = 3;  // of the attempt to believe all
constexpr int inner_iterations = 1;  // for each mu
constexpr int max_rechecks = 10;     // of the closures believed, after the last mu

/// One optimisation under way.
class Optimization {
 public:
  Optimization(const PoseGraph& graph, const PoseGraphOptions& options)
      : graph_(graph), options_(options), weights_(graph.edges.size(), 1.0) {
    for (const PoseGraphEdge& edge : graph.edges) roots_.push_back(square_root(edge.information));
    poses_ = graph.map_from_node;
    bound_ =
        chi_square_quantile(options.inlier_probability, graph.space == GraphSpace::planar ? 3 : 6);
  }

  PoseGraphSolution run() {
    if (options_.robust && !can_believe_all()) graduate();
    settle();
    return solution();
  }

 private:
  double square(std::size_t i, const std::vector<Rigid3>& poses) const {
    const PoseGraphEdge& edge = graph_.edges[i];
    return (roots_[i] *
            edge_error(edge.from_from_to, poses[edge.from], poses[edge.to], graph_.space))
        .squaredNorm();
  }

  bool may_be_false(std::size_t i) const { return graph_.edges[i].kind == EdgeKind::closure; }

  double largest_closure() const {
    double largest = 0.0;
    for (std::size_t i = 0; i < weights_.size(); ++i) {
      if (may_be_false(i)) largest = std::max(largest, square(i, poses_));
    }
    return largest;
  }

  void solve(int max_iterations, double min_cost_change) {
    const LeastSquaresReport report =
        minimise(graph_, roots_, weights_, {max_iterations, min_cost_change}, poses_);
    iterations_ += report.iterations;
    converged_ = report.converged;
  }

  /// Returns whether all weights are 0 or 1.
  bool weigh(double mu) {
    bool decided = true;
    for (std::size_t i = 0; i < weights_.size(); ++i) {
      if (!may_be_false(i)) continue;
      weights_[i] = graduated_weight(square(i, poses_), bound_, mu);
      decided = decided && (weights_[i] == 0.0 || weights_[i] == 1.0);
    }
    return decided;
  }

  /// Believes the closures within the bound; returns whether that changed anything.
  bool decide() {
    const std::vector<double> before = weights_;
    for (std::size_t i = 0; i < weights_.size(); ++i) {
      if (may_be_false(i)) weights_[i] = square(i, poses_) <= bound_ ? 1.0 : 0.0;
    }
    return weights_ != before;
  }

  /// Whether a few steps bring all closures within the bound; if not, the poses are as before.
  bool can_believe_all() {
    solve(std::min(first_iterations, options_.max_iterations), options_.min_cost_change);
    if (largest_closure() <= bound_) return true;
    poses_ = graph_.map_from_node;
    return false;
  }

  /// From a cost that is convex to truncated least squares, a step for each mu.
  void graduate() {
    double mu = first_mu(largest_closure(), bound_);
    if (std::isinf(mu)) return;
    while (!weigh(mu)) {
      solve(inner_iterations, options_.min_cost_change);
      mu *= mu < small_mu ? fast_growth : options_.growth;
    }
    decide();
  }

  /// Solves with full weights, until what is within the bound is what is believed.
  void settle() {
    for (int i = 0; i < max_rechecks; ++i) {
      solve(options_.max_iterations, options_.min_cost_change);
      if (!options_.robust || !decide()) return;
    }
    solve(options_.max_iterations, options_.min_cost_change);
  }

  double cost(const std::vector<Rigid3>& poses) const {
    double sum = 0.0;
    for (std::size_t i = 0; i < weights_.size(); ++i) sum += weights_[i] * square(i, poses);
    return sum;
  }

  PoseGraphSolution solution() const {
    return {poses_, cost(graph_.map_from_node), cost(poses_), iterations_, converged_, weights_};
  }

  const PoseGraph& graph_;
  const PoseGraphOptions& options_;
  std::vector<Matrix6> roots_;
  std::vector<double> weights_;
  std::vector<Rigid3> poses_;
  double bound_ = 0.0;
  int iterations_ = 0;
  bool converged_ = false;
};

}  // namespace

void require_valid(const PoseGraphOptions& options) {
  require_between("max_iterations", options.max_iterations, 1, 1e6);
  require_between("min_cost_change", options.min_cost_change, 0.0, 1.0);
  require_between("inlier_probability", options.inlier_probability, 0.5, 1.0 - 1e-12);
  require_between("growth", options.growth, 1.01, 1e3);
}

PoseGraphSolution optimize(const PoseGraph& graph, const PoseGraphOptions& options) {
  require_valid(options);
  require_valid(graph);
  if (graph.map_from_node.empty()) {
    PoseGraphSolution nothing;
    nothing.converged = true;
    return nothing;
  }
  return Optimization(graph, options).run();
}

double cost(const PoseGraph& graph) {
  require_valid(graph);
  double sum = 0.0;
  for (const PoseGraphEdge& edge : graph.edges) {
    sum += (square_root(edge.information) * edge_error(edge.from_from_to,
                                                       graph.map_from_node[edge.from],
                                                       graph.map_from_node[edge.to],
                                                       graph.space))
               .squaredNorm();
  }
  return sum;
}

}  // namespace kissmap
