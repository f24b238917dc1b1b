// SPDX-License-Identifier: MIT
#include "kissmap/loop_closing/loop_correction.hpp"

#include <algorithm>
#include <iterator>
#include <set>
#include <string>
#include <utility>

#include "kissmap/error.hpp"
#include "kissmap/loop_closing/trajectory_refinement.hpp"

namespace kissmap {
namespace {

PoseGraphEdge edge_of(const Closure& closure) {
  return {closure.reference_id,
          closure.query_id,
          closure.reference_from_query,
          closure.information,
          closure.trusted ? EdgeKind::odometry : EdgeKind::closure};
}

/// Without those between local maps whose closure was removed by hand: they are not one place.
std::vector<SurfaceLink> believable(std::span<const SurfaceLink> links,
                                    std::span<const ScanPlace> scans,
                                    std::span<const Closure> closures) {
  std::set<std::pair<std::uint32_t, std::uint32_t>> removed;
  for (const Closure& closure : closures) {
    if (closure.verdict != ClosureVerdict::removed_by_hand) continue;
    removed.emplace(closure.reference_id, closure.query_id);
  }
  const auto is_removed = [&](const SurfaceLink& link) {
    if (std::max(link.reference_scan, link.query_scan) >= scans.size()) return false;
    return removed.contains(
        {scans[link.reference_scan].local_map_id, scans[link.query_scan].local_map_id});
  };
  std::vector<SurfaceLink> left;
  std::ranges::remove_copy_if(links, std::back_inserter(left), is_removed);
  return left;
}

}  // namespace

PoseGraph keypose_graph(std::span<const Rigid3> map_from_local_map,
                        std::span<const double> path_lengths,
                        std::span<const Closure> closures) {
  if (path_lengths.size() != map_from_local_map.size()) {
    throw Error(Fault::input,
                std::to_string(path_lengths.size()) + " path lengths for " +
                    std::to_string(map_from_local_map.size()) + " local maps");
  }
  PoseGraph graph;
  graph.map_from_node.assign(map_from_local_map.begin(), map_from_local_map.end());
  for (std::uint32_t id = 1; id < map_from_local_map.size(); ++id) {
    graph.edges.push_back({id - 1,
                           id,
                           map_from_local_map[id - 1].inverse() * map_from_local_map[id],
                           odometry_information(path_lengths[id - 1]),
                           EdgeKind::odometry});
  }
  for (const Closure& closure : closures) {
    if (enters_graph(closure)) graph.edges.push_back(edge_of(closure));
  }
  return graph;
}

void set_verdicts(std::span<const double> edge_weights, std::vector<Closure>& closures) {
  const auto count = static_cast<std::size_t>(std::ranges::count_if(closures, enters_graph));
  std::size_t edge = edge_weights.size() - count;  // odometry comes first
  for (Closure& closure : closures) {
    if (!enters_graph(closure)) continue;
    closure.verdict =
        edge_weights[edge++] > 0.5 ? ClosureVerdict::accepted : ClosureVerdict::refused_by_graph;
  }
}

LoopCorrection correct_loops(std::span<const ScanPlace> scans, const LoopEvidence& evidence) {
  LoopCorrection corrected;
  corrected.closures = evidence.closures;
  corrected.neighbors = evidence.neighbors;
  corrected.surfaces = evidence.surfaces;
  corrected.graph =
      keypose_graph(evidence.map_from_local_map, evidence.path_lengths, evidence.closures);
  PoseGraphSolution solution = optimize(corrected.graph, {});
  set_verdicts(solution.edge_weights, corrected.closures);
  corrected.graph.map_from_node = std::move(solution.map_from_node);
  corrected.edge_weights = std::move(solution.edge_weights);
  std::vector<Closure> accepted;
  std::ranges::copy_if(
      corrected.closures, std::back_inserter(accepted), [](const Closure& closure) {
        return closure.verdict == ClosureVerdict::accepted;
      });
  RefinedTrajectory refined =
      refine_trajectory(scans,
                        corrected.graph.map_from_node,
                        accepted,
                        evidence.neighbors,
                        believable(evidence.surfaces, scans, corrected.closures));
  corrected.map_from_lidar = std::move(refined.map_from_lidar);
  corrected.map_from_local_map = std::move(refined.map_from_local_map);
  return corrected;
}

}  // namespace kissmap
