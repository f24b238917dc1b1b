// SPDX-License-Identifier: MIT
#include "drift.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <queue>
#include <utility>

#include "kissmap/loop_closing/loop_correction.hpp"

namespace kissmap {
namespace {

constexpr double closure_length = 1.0;     // m
constexpr double walk_translation = 0.03;  // m per square root of m
constexpr double walk_rotation = 0.003;    // rad per square root of m
constexpr double least_length = 0.1;       // m
// Odometry that is off by more than 6 % of the path has failed.
constexpr double most_translation_first = 1.0;   // m
constexpr double most_translation = 0.06;        // m per m
constexpr double most_rotation_first = 0.03;     // rad
constexpr double most_rotation = 0.015;          // rad per square root of m
constexpr double usual_translation_first = 0.3;  // m
constexpr double usual_translation = 0.02;       // m per m
constexpr double usual_translation_last = 1.0;   // m
constexpr double usual_rotation_first = 0.02;    // rad
constexpr double usual_rotation = 0.003;         // rad per square root of m
constexpr double usual_rotation_last = 0.05;     // rad

struct Neighbor {
  std::uint32_t node;
  double length;
};

std::vector<std::vector<Neighbor>> neighbors(const PoseGraph& graph,
                                             const std::vector<double>& path_lengths) {
  std::vector<std::vector<Neighbor>> all(graph.map_from_node.size());
  for (const PoseGraphEdge& edge : graph.edges) {
    const double length =
        edge.kind == EdgeKind::odometry ? path_lengths[edge.from] : closure_length;
    all[edge.from].push_back({edge.to, length});
    all[edge.to].push_back({edge.from, length});
  }
  return all;
}

}  // namespace

double drift_length(const PoseGraph& graph,
                    const std::vector<double>& path_lengths,
                    std::uint32_t from,
                    std::uint32_t to) {
  // Dijkstra's algorithm.
  const auto adjacent = neighbors(graph, path_lengths);
  std::vector<double> length(adjacent.size(), std::numeric_limits<double>::infinity());
  using Open = std::pair<double, std::uint32_t>;
  std::priority_queue<Open, std::vector<Open>, std::greater<>> open;
  length[from] = 0.0;
  open.emplace(0.0, from);
  while (!open.empty()) {
    const auto [so_far, node] = open.top();
    open.pop();
    if (node == to) break;
    if (so_far > length[node]) continue;
    for (const Neighbor& next : adjacent[node]) {
      const double candidate = so_far + next.length;
      if (candidate >= length[next.node]) continue;
      length[next.node] = candidate;
      open.emplace(candidate, next.node);
    }
  }
  return length[to];
}

double max_drift_translation(double length) {
  return most_translation_first + most_translation * length;
}

double max_drift_rotation(double length) {
  return most_rotation_first + most_rotation * std::sqrt(length);
}

bool within_drift(const Rigid3& off, double length) {
  return off.translation.norm() <= max_drift_translation(length) &&
         off.angle() <= max_drift_rotation(length);
}

bool is_expected(const Rigid3& off, double length) {
  const double translation =
      std::min(usual_translation_last, usual_translation_first + usual_translation * length);
  const double rotation =
      std::min(usual_rotation_last, usual_rotation_first + usual_rotation * std::sqrt(length));
  return off.translation.norm() <= translation && off.angle() <= rotation;
}

Information odometry_information(double length) {
  const double path = std::max(least_length, length);
  Information information = Information::Zero();
  information.diagonal().head<3>().setConstant(1.0 / (walk_translation * walk_translation * path));
  information.diagonal().tail<3>().setConstant(1.0 / (walk_rotation * walk_rotation * path));
  return information;
}

}  // namespace kissmap
