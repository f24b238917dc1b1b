// SPDX-License-Identifier: MIT
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "kissmap/geometry/rigid3.hpp"

namespace kissmap {

/// Information (inverse covariance) of an edge over the order of Twist: translation [1/m^2], then
/// rotation vector [1/rad^2], in the frame of the edge's `to` node. Symmetric, not negative.
using Information = Eigen::Matrix<double, 6, 6>;

/// Odometry is trusted; closures may be false.
enum class EdgeKind : std::uint8_t { odometry, closure };

/// A measured relative pose.
struct PoseGraphEdge {
  std::uint32_t from = 0;  ///< index of a node
  std::uint32_t to = 0;    ///< index of another node
  Rigid3 from_from_to;     ///< measured pose of `to` in the frame of `from`
  Information information = Information::Identity();
  EdgeKind kind = EdgeKind::odometry;
};

/// In a planar graph every pose turns about z and lies in the plane z = 0. Its rotation error is
/// the angle, that of a spatial graph is twice the vector part of the quaternion; both as in g2o.
enum class GraphSpace : std::uint8_t { spatial, planar };

struct PoseGraph {
  std::vector<Rigid3> map_from_node;  ///< start values
  std::vector<PoseGraphEdge> edges;
  std::vector<std::uint32_t> fixed{0};  ///< nodes held where they are: the gauge
  GraphSpace space = GraphSpace::spatial;
};

struct PoseGraphOptions {
  bool robust = true;             ///< whether closures may be refused
  int max_iterations = 100;       ///< of each least-squares solve
  double min_cost_change = 1e-9;  ///< relative; a smaller change ends a solve
  /// A closure is believed while its whitened error is one that a fraction of this size of true
  /// closures would stay below (chi-square distribution).
  double inlier_probability = 0.999;
  /// Factor from step to step of mu, by which the cost turns from a convex one to one that refuses
  /// outright what contradicts the rest (1.4 in the paper); a larger one takes fewer steps.
  double growth = 1.4;
};

/// Throws Error(usage) naming the option.
void require_valid(const PoseGraphOptions& options);

struct PoseGraphSolution {
  std::vector<Rigid3> map_from_node;
  double initial_cost = 0.0;         ///< of the start values, over the edges believed at the end
  double final_cost = 0.0;           ///< the same of the result
  int iterations = 0;                ///< of all solves together
  bool converged = false;            ///< whether the last solve ended before max_iterations
  std::vector<double> edge_weights;  ///< 1 believed, 0 refused; one an edge
};

/// Poses of least cost: the sum over the edges of e^T information e with
/// e = (translation; 2 * vector part of the quaternion, w >= 0) of
/// from_from_to^-1 * map_from_node[from]^-1 * map_from_node[to], which is the chi2 of g2o.
/// If `robust`, closures are weighted by graduated non-convexity with truncated least squares (Yang
/// et al., RA-L 2020, eq. 14); what is believed in the end counts fully, the rest not at all.
/// A part of the graph that hangs on refused closures alone stays where it is, as a rigid body.
/// Throws Error(input) for indices out of range, edges of a node to itself, numbers that are not
/// finite, information that is negative or not symmetric, nodes no chain of edges ties to a fixed
/// one. One thread, the same result on every run. Thread safe.
PoseGraphSolution optimize(const PoseGraph& graph, const PoseGraphOptions& options);

/// The cost above of the start values over all edges. Throws like optimize().
double cost(const PoseGraph& graph);

/// Start values from the edges alone, whatever map_from_node holds for nodes that are not fixed:
/// chordal relaxation (Carlone et al., ICRA 2015, section III-B), that is rotations by linear
/// least squares over matrices, each then projected, and translations by linear least squares.
/// False closures spoil it. Throws like optimize().
std::vector<Rigid3> chordal_start(const PoseGraph& graph);

/// Start values along a spanning tree from the fixed nodes which uses closures only where odometry
/// does not reach. Throws like optimize().
std::vector<Rigid3> tree_start(const PoseGraph& graph);

}  // namespace kissmap
