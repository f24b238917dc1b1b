// SPDX-License-Identifier: MIT
#pragma once

#include <cmath>
#include <numbers>
#include <random>
#include <vector>

#include "kissmap/graph/pose_graph.hpp"

namespace kissmap {

/// A drive round and round a wavy circle with exact truth: odometry between consecutive nodes,
/// closures between nodes that are close, both with Gaussian noise of the information they state.
struct LoopGraph {
  std::vector<Rigid3> truth;
  PoseGraph graph;
  std::vector<bool> is_false;  ///< one an edge
};

struct LoopGraphOptions {
  int nodes = 200;
  int laps = 2;
  double radius = 100.0;  ///< m
  double metres = 0.1;    ///< standard deviation of an edge's translations
  double radians = 0.005;
  int max_closures = 300;
};

inline Rigid3 noise(std::mt19937& random, double metres, double radians) {
  std::normal_distribution<double> normal;
  Twist twist;
  for (double& value : twist) value = normal(random);
  twist.head<3>() *= metres;
  twist.tail<3>() *= radians;
  return exp(twist);
}

inline Rigid3 random_pose(std::mt19937& random, double size) {
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  std::normal_distribution<double> normal;
  Rigid3 pose;
  for (double& value : pose.translation) value = size * unit(random);
  for (double& value : pose.rotation.coeffs()) value = normal(random);
  pose.rotation.normalize();
  return pose;
}

inline Information information_of(double metres, double radians) {
  Twist diagonal;
  diagonal.head<3>().setConstant(1.0 / (metres * metres));
  diagonal.tail<3>().setConstant(1.0 / (radians * radians));
  return diagonal.asDiagonal();
}

inline void add_edge(LoopGraph& loop,
                     std::uint32_t from,
                     std::uint32_t to,
                     const Rigid3& from_from_to,
                     const LoopGraphOptions& options,
                     bool is_false = false) {
  PoseGraphEdge edge{from, to, from_from_to, {}, EdgeKind::closure};
  edge.information =
      information_of(std::max(options.metres, 1e-3), std::max(options.radians, 1e-4));
  if (to == from + 1) edge.kind = EdgeKind::odometry;
  loop.graph.edges.push_back(edge);
  loop.is_false.push_back(is_false);
}

/// Start values are those of the odometry alone.
inline LoopGraph loop_graph(std::mt19937& random, const LoopGraphOptions& options = {}) {
  LoopGraph loop;
  for (int i = 0; i < options.nodes; ++i) {
    const double angle = 2.0 * std::numbers::pi * options.laps * i / options.nodes;
    Rigid3 pose;
    pose.rotation = Eigen::AngleAxisd(angle + std::numbers::pi / 2, Eigen::Vector3d::UnitZ()) *
                    Eigen::AngleAxisd(0.1 * std::sin(3.0 * angle), Eigen::Vector3d::UnitX());
    pose.translation = {options.radius * std::cos(angle),
                        options.radius * std::sin(angle),
                        0.05 * options.radius * std::sin(2.0 * angle)};
    loop.truth.push_back(pose);
  }
  const auto measured = [&](std::uint32_t from, std::uint32_t to) {
    return loop.truth[from].inverse() * loop.truth[to] *
           noise(random, options.metres, options.radians);
  };
  const auto nodes = static_cast<std::uint32_t>(options.nodes);
  for (std::uint32_t i = 1; i < nodes; ++i) add_edge(loop, i - 1, i, measured(i - 1, i), options);
  const auto lap = static_cast<std::uint32_t>(options.nodes / options.laps);
  int closures = 0;
  for (std::uint32_t to = lap; to < nodes; ++to) {
    for (std::uint32_t from = to - lap; from <= to - lap + 2; ++from) {
      if (closures++ < options.max_closures) add_edge(loop, from, to, measured(from, to), options);
    }
  }
  loop.graph.map_from_node.resize(loop.truth.size());
  loop.graph.map_from_node[0] = loop.truth[0];
  loop.graph.map_from_node = tree_start(loop.graph);
  return loop;
}

/// Adds false closures between random nodes until they are `share` of all closures.
inline void add_false_closures(LoopGraph& loop,
                               double share,
                               std::mt19937& random,
                               const LoopGraphOptions& options = {}) {
  const auto truths = loop.graph.edges.size() + 1 - loop.truth.size();
  const auto count =
      static_cast<int>(std::lround(share / (1.0 - share) * static_cast<double>(truths)));
  const auto last = static_cast<std::uint32_t>(loop.truth.size() - 1);
  std::uniform_int_distribution<std::uint32_t> node(0, last);
  for (int added = 0; added < count;) {
    const std::uint32_t from = node(random);
    const std::uint32_t to = node(random);
    if (from + 1 >= to) continue;
    add_edge(loop, from, to, random_pose(random, 5.0), options, true);
    ++added;
  }
}

/// Root mean square of the position errors; node 0 is held at the truth.
inline double position_error(const std::vector<Rigid3>& poses, const std::vector<Rigid3>& truth) {
  double sum = 0.0;
  for (std::size_t i = 0; i < poses.size(); ++i) {
    sum += (poses[i].translation - truth[i].translation).squaredNorm();
  }
  return std::sqrt(sum / static_cast<double>(poses.size()));
}

}  // namespace kissmap
