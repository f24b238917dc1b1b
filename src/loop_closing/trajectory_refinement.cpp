// SPDX-License-Identifier: MIT
#include "kissmap/loop_closing/trajectory_refinement.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "kissmap/error.hpp"
#include "kissmap/loop_closing/loop_correction.hpp"

namespace kissmap {
namespace {

constexpr ClosureSigmas closure_sigmas{0.05, 0.004};
// How well openings fit that reach far. The less far they reach, the fewer surfaces there are, and
// the shorter are the levers that turn them.
constexpr ClosureSigmas neighbor_sigmas{0.05, 0.002};
constexpr double far_reaching = 25.0;  // m

// From scan to scan odometry turns by more than its drift over metres tells. Where surfaces say how
// scans lie, it has as little to say as that.
constexpr double wavering = 0.007;  // rad

ClosureSigmas sigmas_of(const NeighborLink& neighbor) {
  const double share = std::min(1.0, neighbor.extent / far_reaching);
  return {neighbor_sigmas.metres / share, neighbor_sigmas.radians / (share * share)};
}

/// The scans of one local map: [first, end).
struct Range {
  std::uint32_t first = 0;
  std::uint32_t end = 0;
};

std::vector<Range> ranges_of(std::span<const ScanPlace> scans, std::size_t local_maps) {
  std::vector<Range> ranges(local_maps);
  for (std::uint32_t i = 0; i < scans.size(); ++i) {
    if (scans[i].local_map_id >= local_maps) {
      throw input_error("trajectory", "scan " + std::to_string(i) + " has no local map");
    }
    Range& range = ranges[scans[i].local_map_id];
    if (range.end == 0) range.first = i;
    range.end = i + 1;
  }
  return ranges;
}

std::uint32_t nearest_scan(std::span<const ScanPlace> scans,
                           const Range& range,
                           const Eigen::Vector3d& point) {
  std::uint32_t nearest = range.first;
  double least = std::numeric_limits<double>::infinity();
  for (std::uint32_t i = range.first; i < range.end; ++i) {
    const double distance = (scans[i].local_map_from_lidar.translation - point).squaredNorm();
    if (distance >= least) continue;
    least = distance;
    nearest = i;
  }
  return nearest;
}

/// The scan at half the way: where a local map as a whole is placed best.
std::uint32_t middle_scan(std::span<const ScanPlace> scans, const Range& range) {
  std::vector<double> way{0.0};
  for (std::uint32_t i = range.first + 1; i < range.end; ++i) {
    way.push_back(way.back() + (scans[i].local_map_from_lidar.translation -
                                scans[i - 1].local_map_from_lidar.translation)
                                   .norm());
  }
  const auto half = std::ranges::lower_bound(way, 0.5 * way.back());
  return range.first + static_cast<std::uint32_t>(half - way.begin());
}

PoseGraphEdge link(std::span<const ScanPlace> scans,
                   std::uint32_t reference,
                   std::uint32_t query,
                   const Rigid3& reference_map_from_query_map,
                   const ClosureSigmas& sigmas) {
  Information information = Information::Zero();
  information.diagonal().head<3>().setConstant(1.0 / (sigmas.metres * sigmas.metres));
  information.diagonal().tail<3>().setConstant(1.0 / (sigmas.radians * sigmas.radians));
  return {reference,
          query,
          scans[reference].local_map_from_lidar.inverse() * reference_map_from_query_map *
              scans[query].local_map_from_lidar,
          information,
          EdgeKind::closure};
}

/// Of the edges from scan to scan, which come first.
void loosen_rotations(std::size_t scans, PoseGraph& graph) {
  for (std::size_t i = 0; i + 1 < scans; ++i) {
    auto information = graph.edges[i].information.diagonal().tail<3>();
    information = (information.array().inverse() + wavering * wavering).inverse();
  }
}

void add_closures(std::span<const Closure> closures,
                  std::span<const ScanPlace> scans,
                  const std::vector<Range>& ranges,
                  PoseGraph& graph) {
  const auto holds_scans = [&ranges](const Closure& closure) {
    return closure.query_id < ranges.size() && closure.reference_id < ranges.size() &&
           ranges[closure.query_id].end > 0 && ranges[closure.reference_id].end > 0;
  };
  for (const Closure& closure : closures) {
    if (!holds_scans(closure)) throw input_error("closures", "a local map has no scans");
    const Eigen::Vector3d center = closure.center_in_query;
    graph.edges.push_back(link(
        scans,
        nearest_scan(scans, ranges[closure.reference_id], closure.reference_from_query * center),
        nearest_scan(scans, ranges[closure.query_id], center),
        closure.reference_from_query,
        closure.sigmas.value_or(closure_sigmas)));
    if (closure.trusted) graph.edges.back().kind = EdgeKind::odometry;
  }
}

void add_neighbors(std::span<const NeighborLink> neighbors,
                   std::span<const ScanPlace> scans,
                   const std::vector<Range>& ranges,
                   PoseGraph& graph) {
  for (const NeighborLink& neighbor : neighbors) {
    if (neighbor.reference_id + 1 >= ranges.size()) {
      throw input_error("neighbors", "a local map has no scans");
    }
    const Range& reference = ranges[neighbor.reference_id];
    const Range& query = ranges[neighbor.reference_id + 1];
    if (reference.first + neighbor.reference_scan >= reference.end ||
        query.first + neighbor.query_scan >= query.end) {
      throw input_error("neighbors", "a local map has fewer scans");
    }
    graph.edges.push_back(link(scans,
                               reference.first + neighbor.reference_scan,
                               query.first + neighbor.query_scan,
                               neighbor.reference_from_query,
                               sigmas_of(neighbor)));
  }
}

}  // namespace

RefinedTrajectory refine_trajectory(std::span<const ScanPlace> scans,
                                    const std::vector<Rigid3>& map_from_local_map,
                                    std::span<const Closure> closures,
                                    std::span<const NeighborLink> neighbors,
                                    std::span<const SurfaceLink> surfaces) {
  const std::vector<Range> ranges = ranges_of(scans, map_from_local_map.size());
  PoseGraph graph;
  for (const ScanPlace& scan : scans) {
    graph.map_from_node.push_back(map_from_local_map[scan.local_map_id] *
                                  scan.local_map_from_lidar);
  }
  for (std::uint32_t i = 1; i < scans.size(); ++i) {
    // The keypose of the next local map is the last scan of this one.
    const bool same = scans[i].local_map_id == scans[i - 1].local_map_id;
    const Rigid3 motion =
        same ? scans[i - 1].local_map_from_lidar.inverse() * scans[i].local_map_from_lidar
             : scans[i].local_map_from_lidar;
    graph.edges.push_back(
        {i - 1, i, motion, odometry_information(motion.translation.norm()), EdgeKind::odometry});
  }
  add_closures(closures, scans, ranges, graph);
  add_neighbors(neighbors, scans, ranges, graph);
  PoseGraphOptions options;
  options.robust = false;
  RefinedTrajectory refined{optimize(graph, options).map_from_node, map_from_local_map};
  if (!surfaces.empty()) {
    graph.map_from_node = std::move(refined.map_from_lidar);
    loosen_rotations(scans.size(), graph);
    refined.map_from_lidar = fit_surfaces(std::move(graph), surfaces);
  }
  for (std::size_t id = 0; id < ranges.size(); ++id) {
    if (ranges[id].end == 0) continue;
    const std::uint32_t middle = middle_scan(scans, ranges[id]);
    refined.map_from_local_map[id] =
        refined.map_from_lidar[middle] * scans[middle].local_map_from_lidar.inverse();
  }
  return refined;
}

}  // namespace kissmap
