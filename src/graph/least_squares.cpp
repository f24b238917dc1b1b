// SPDX-License-Identifier: MIT
#include "graph/least_squares.hpp"

#include <ceres/ceres.h>

#include <array>
#include <cmath>
#include <string>

#include "graph/components.hpp"
#include "kissmap/error.hpp"

namespace kissmap {
namespace {

using Block = std::array<double, 7>;  // x y z qx qy qz qw
template <int rows, int columns>
using RowMajor = Eigen::Matrix<double, rows, columns, Eigen::RowMajor>;

Block block_of(const Rigid3& pose) {
  Block block;
  Eigen::Map<Eigen::Vector3d>(block.data()) = pose.translation;
  Eigen::Map<Eigen::Vector4d>(block.data() + 3) = pose.rotation.coeffs();
  return block;
}

Rigid3 pose_of(const double* block) {
  return {Eigen::Quaterniond(Eigen::Map<const Eigen::Vector4d>(block + 3)),
          Eigen::Map<const Eigen::Vector3d>(block)};
}

// Steps of a pose in its own frame. Costs give their derivatives by the step in the first six of
// seven columns, so the Jacobian of a step by the block just drops the seventh.
class PoseManifold final : public ceres::Manifold {
 public:
  int AmbientSize() const override { return 7; }
  int TangentSize() const override { return 6; }

  bool Plus(const double* x, const double* step, double* moved) const override {
    const Block block = block_of(stepped(pose_of(x), Eigen::Map<const Twist>(step)));
    std::copy(block.begin(), block.end(), moved);
    return true;
  }
  bool PlusJacobian(const double*, double* jacobian) const override {
    Eigen::Map<RowMajor<7, 6>>(jacobian).setIdentity();
    return true;
  }
  bool Minus(const double* y, const double* x, double* step) const override {
    Eigen::Map<Twist> out(step);
    const Rigid3 x_from_y = pose_of(x).inverse() * pose_of(y);
    out << x_from_y.translation, log({x_from_y.rotation, Eigen::Vector3d::Zero()}).tail<3>();
    return true;
  }
  bool MinusJacobian(const double*, double* jacobian) const override {
    Eigen::Map<RowMajor<6, 7>>(jacobian).setIdentity();
    return true;
  }
};

class EdgeCost final : public ceres::SizedCostFunction<6, 7, 7> {
 public:
  EdgeCost(const Rigid3& from_from_to, const Matrix6& root, GraphSpace space)
      : from_from_to_(from_from_to), root_(root), space_(space) {}

  bool Evaluate(double const* const* blocks, double* residuals, double** jacobians) const override {
    const Rigid3 from = pose_of(blocks[0]);
    const Rigid3 to = pose_of(blocks[1]);
    Eigen::Map<Twist> whitened(residuals);
    if (jacobians == nullptr) {
      whitened = root_ * edge_error(from_from_to_, from, to, space_);
      return true;
    }
    const EdgeResidual r = edge_residual(from_from_to_, from, to, space_);
    whitened = root_ * r.error;
    write(jacobians[0], r.by_from);
    write(jacobians[1], r.by_to);
    return true;
  }

 private:
  void write(double* jacobian, const Matrix6& by_step) const {
    if (jacobian == nullptr) return;
    Eigen::Map<RowMajor<6, 7>> out(jacobian);
    out.leftCols<6>() = root_ * by_step;
    out.col(6).setZero();
  }

  Rigid3 from_from_to_;
  Matrix6 root_;
  GraphSpace space_;
};

ceres::Solver::Options solver_options(const LeastSquaresLimits& limits) {
  ceres::Solver::Options options;
  options.linear_solver_type = ceres::SPARSE_NORMAL_CHOLESKY;
  options.sparse_linear_algebra_library_type = ceres::SUITE_SPARSE;  // 3 times as fast as Eigen
  options.num_threads = 1;  // sums in another order would be other sums
  options.max_num_iterations = limits.max_iterations;
  options.function_tolerance = limits.min_cost_change;
  options.gradient_tolerance = 1e-12;
  options.parameter_tolerance = 1e-14;
  options.initial_trust_region_radius = 1e8;  // almost Gauss-Newton until a step fails
  options.logging_type = ceres::SILENT;
  return options;
}

ceres::Problem::Options borrowing_manifold() {
  ceres::Problem::Options options;
  options.manifold_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
  return options;
}

}  // namespace

LeastSquaresReport minimise(const PoseGraph& graph,
                            const std::vector<Matrix6>& roots,
                            const std::vector<double>& weights,
                            const LeastSquaresLimits& limits,
                            std::vector<Rigid3>& poses) {
  std::vector<Block> blocks;
  blocks.reserve(poses.size());
  for (const Rigid3& pose : poses) blocks.push_back(block_of(pose));
  PoseManifold manifold;
  ceres::Problem problem(borrowing_manifold());
  for (Block& block : blocks) problem.AddParameterBlock(block.data(), 7, &manifold);
  for (std::size_t i = 0; i < graph.edges.size(); ++i) {
    if (weights[i] <= 0.0) continue;
    const PoseGraphEdge& edge = graph.edges[i];
    problem.AddResidualBlock(
        new EdgeCost(edge.from_from_to, std::sqrt(weights[i]) * roots[i], graph.space),
        nullptr,
        blocks[edge.from].data(),
        blocks[edge.to].data());
  }
  for (const std::uint32_t node : held_nodes(graph, weights)) {
    problem.SetParameterBlockConstant(blocks[node].data());
  }
  ceres::Solver::Summary summary;
  ceres::Solve(solver_options(limits), &problem, &summary);
  if (!summary.IsSolutionUsable()) {
    throw Error(Fault::input, "pose graph: cannot be solved: " + summary.message);
  }
  for (std::size_t i = 0; i < poses.size(); ++i) poses[i] = pose_of(blocks[i].data());
  return {static_cast<int>(summary.iterations.size()) - 1,
          summary.termination_type == ceres::CONVERGENCE};
}

}  // namespace kissmap
