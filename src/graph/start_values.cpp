// SPDX-License-Identifier: MIT
#include <Eigen/SparseCholesky>
#include <algorithm>
#include <cmath>

#include "graph/components.hpp"
#include "kissmap/error.hpp"
#include "kissmap/graph/pose_graph.hpp"

namespace kissmap {
namespace {

using Eigen::Matrix3d;
using Eigen::MatrixXd;
using SparseMatrix = Eigen::SparseMatrix<double>;

/// Linear least squares for a block of unknowns a node, `size` x 3, some of them known.
class BlockLeastSquares {
 public:
  /// `known[i]` is the block of node i if `held[i]`.
  BlockLeastSquares(int size, const std::vector<bool>& held, std::vector<MatrixXd> known)
      : size_(size), blocks_(std::move(known)), row_(held.size(), -1) {
    int row = 0;
    for (std::size_t i = 0; i < held.size(); ++i) {
      if (held[i]) continue;
      row_[i] = row;
      row += size;
    }
    right_ = MatrixXd::Zero(row, 3);
  }

  /// Adds weight * |x_to - a x_from - offset|^2.
  void add(const PoseGraphEdge& edge, const MatrixXd& a, const MatrixXd& offset, double weight) {
    const int from = row_[edge.from];
    const int to = row_[edge.to];
    const MatrixXd at = weight * a.transpose();
    if (to >= 0) {
      add_block(to, to, weight * MatrixXd::Identity(size_, size_));
      right_.middleRows(to, size_) +=
          weight * (from >= 0 ? offset : MatrixXd(offset + a * blocks_[edge.from]));
    }
    if (from >= 0) {
      add_block(from, from, at * a);
      right_.middleRows(from, size_) +=
          at * (to >= 0 ? MatrixXd(-offset) : MatrixXd(blocks_[edge.to] - offset));
    }
    if (from < 0 || to < 0) return;
    if (to > from) {
      add_block(to, from, -weight * a);
    } else {
      add_block(from, to, -at);
    }
  }

  /// The blocks of all nodes.
  std::vector<MatrixXd> solve() && {
    if (right_.rows() == 0) return std::move(blocks_);
    SparseMatrix lower(right_.rows(), right_.rows());
    lower.setFromTriplets(entries_.begin(), entries_.end());
    const Eigen::SimplicialLDLT<SparseMatrix> factors(lower);
    if (factors.info() != Eigen::Success) fail();
    const MatrixXd solution = factors.solve(right_);
    if (!solution.allFinite()) fail();
    for (std::size_t i = 0; i < row_.size(); ++i) {
      if (row_[i] >= 0) blocks_[i] = solution.middleRows(row_[i], size_);
    }
    return std::move(blocks_);
  }

 private:
  [[noreturn]] static void fail() {
    throw Error(Fault::input, "pose graph: its edges do not determine start values");
  }

  void add_block(int row, int column, const MatrixXd& block) {
    for (int i = 0; i < size_; ++i) {
      for (int k = 0; k < size_; ++k) {
        if (row + i >= column + k) entries_.emplace_back(row + i, column + k, block(i, k));
      }
    }
  }

  int size_;
  std::vector<MatrixXd> blocks_;
  std::vector<int> row_;  // first unknown of each node, -1 if it is held
  std::vector<Eigen::Triplet<double>> entries_;
  MatrixXd right_;
};

std::vector<bool> is_fixed(const PoseGraph& graph) {
  std::vector<bool> fixed(graph.map_from_node.size(), false);
  for (const std::uint32_t node : graph.fixed) fixed[node] = true;
  return fixed;
}

// An edge that says nothing still counts a little, so that the equations can be solved.
double weight_of(const PoseGraphEdge& edge, int first) {
  constexpr double least = 1e-6;
  return std::max(edge.information.diagonal().segment<3>(first).mean(), least);
}

Eigen::Quaterniond nearest_rotation(const Matrix3d& m, GraphSpace space) {
  if (space == GraphSpace::planar) {
    const double half = 0.5 * std::atan2(m(1, 0) - m(0, 1), m(0, 0) + m(1, 1));
    return {std::cos(half), 0.0, 0.0, std::sin(half)};
  }
  Eigen::Matrix<double, 3, 4> matrix = Eigen::Matrix<double, 3, 4>::Zero();
  matrix.leftCols<3>() = m;
  return Rigid3::from_matrix(matrix).rotation;
}

// The transposes R^T are the unknowns: R_to = R_from R_edge reads R_to^T = R_edge^T R_from^T.
void set_chordal_rotations(const PoseGraph& graph, std::vector<Rigid3>& poses) {
  std::vector<MatrixXd> known;
  known.reserve(poses.size());
  for (const Rigid3& pose : poses) {
    known.emplace_back(pose.rotation.conjugate().toRotationMatrix());
  }
  const std::vector<bool> fixed = is_fixed(graph);
  BlockLeastSquares system(3, fixed, std::move(known));
  for (const PoseGraphEdge& edge : graph.edges) {
    system.add(edge,
               edge.from_from_to.rotation.conjugate().toRotationMatrix(),
               Matrix3d::Zero(),
               weight_of(edge, 3));
  }
  const std::vector<MatrixXd> transposed = std::move(system).solve();
  for (std::size_t i = 0; i < poses.size(); ++i) {
    if (!fixed[i]) poses[i].rotation = nearest_rotation(transposed[i].transpose(), graph.space);
  }
}

void set_translations(const PoseGraph& graph, std::vector<Rigid3>& poses) {
  std::vector<MatrixXd> known;
  known.reserve(poses.size());
  for (const Rigid3& pose : poses) known.emplace_back(pose.translation.transpose());
  BlockLeastSquares system(1, is_fixed(graph), std::move(known));
  for (const PoseGraphEdge& edge : graph.edges) {
    const Eigen::Vector3d way = poses[edge.from].rotation * edge.from_from_to.translation;
    system.add(edge, MatrixXd::Identity(1, 1), way.transpose(), weight_of(edge, 0));
  }
  const std::vector<MatrixXd> rows = std::move(system).solve();
  for (std::size_t i = 0; i < poses.size(); ++i) poses[i].translation = rows[i].transpose();
}

/// Edges of a spanning tree, odometry first.
std::vector<std::uint32_t> tree_edges(const PoseGraph& graph) {
  Components components(graph.map_from_node.size());
  for (const std::uint32_t node : graph.fixed) components.join(graph.fixed.front(), node);
  std::vector<std::uint32_t> tree;
  for (const EdgeKind kind : {EdgeKind::odometry, EdgeKind::closure}) {
    for (std::uint32_t i = 0; i < graph.edges.size(); ++i) {
      const PoseGraphEdge& edge = graph.edges[i];
      if (edge.kind == kind && components.join(edge.from, edge.to)) tree.push_back(i);
    }
  }
  return tree;
}

}  // namespace

std::vector<Rigid3> chordal_start(const PoseGraph& graph) {
  require_valid(graph);
  std::vector<Rigid3> poses = graph.map_from_node;
  if (poses.empty()) return poses;
  set_chordal_rotations(graph, poses);
  set_translations(graph, poses);
  return poses;
}

std::vector<Rigid3> tree_start(const PoseGraph& graph) {
  require_valid(graph);
  std::vector<Rigid3> poses = graph.map_from_node;
  if (poses.empty()) return poses;
  std::vector<std::vector<std::uint32_t>> edges_at(poses.size());
  for (const std::uint32_t i : tree_edges(graph)) {
    edges_at[graph.edges[i].from].push_back(i);
    edges_at[graph.edges[i].to].push_back(i);
  }
  std::vector<bool> placed = is_fixed(graph);
  std::vector<std::uint32_t> queue;
  for (std::uint32_t node = 0; node < poses.size(); ++node) {
    if (placed[node]) queue.push_back(node);
  }
  for (std::size_t next = 0; next < queue.size(); ++next) {
    for (const std::uint32_t i : edges_at[queue[next]]) {
      const PoseGraphEdge& edge = graph.edges[i];
      const bool forward = placed[edge.from];
      const std::uint32_t node = forward ? edge.to : edge.from;
      if (placed[node]) continue;
      poses[node] = forward ? poses[edge.from] * edge.from_from_to
                            : poses[edge.to] * edge.from_from_to.inverse();
      placed[node] = true;
      queue.push_back(node);
    }
  }
  return poses;
}

}  // namespace kissmap
