// SPDX-License-Identifier: MIT
#include "kissmap/graph/trajectory_spread.hpp"

#include <algorithm>

#include "kissmap/error.hpp"
#include "kissmap/graph/pose_graph.hpp"
#include "options.hpp"

namespace kissmap {
namespace {

void require_same_keyposes(const std::vector<Rigid3>& before, const std::vector<Rigid3>& after) {
  if (before.size() == after.size()) return;
  throw Error(Fault::input,
              std::to_string(before.size()) + " keyposes became " + std::to_string(after.size()));
}

/// Number of scans from the front of `scans` in the first one's local map.
std::size_t scans_of_first_map(std::span<const ScanPlace> scans) {
  const std::uint32_t id = scans.front().local_map_id;
  const auto end =
      std::ranges::find_if(scans, [id](const ScanPlace& s) { return s.local_map_id != id; });
  return static_cast<std::size_t>(end - scans.begin());
}

Information information_of(const Rigid3& motion, const SpreadOptions& options) {
  const double way = std::max(motion.translation.norm(), options.least_way);
  const double metres = options.metres_per_sqrt_metre;
  const double radians = options.radians_per_sqrt_metre;
  Twist diagonal;
  diagonal.head<3>().setConstant(1.0 / (metres * metres * way));
  diagonal.tail<3>().setConstant(1.0 / (radians * radians * way));
  return diagonal.asDiagonal();
}

/// Keypose and scans of one local map as a chain of odometry.
PoseGraph chain_of(std::span<const ScanPlace> scans,
                   const Rigid3& keypose,
                   const SpreadOptions& options) {
  PoseGraph chain;
  chain.map_from_node.push_back(keypose);
  Rigid3 last;
  for (const ScanPlace& scan : scans) {
    const auto node = static_cast<std::uint32_t>(chain.map_from_node.size());
    const Rigid3 motion = last.inverse() * scan.local_map_from_lidar;
    chain.edges.push_back(
        {node - 1, node, motion, information_of(motion, options), EdgeKind::odometry});
    chain.map_from_node.push_back(keypose * scan.local_map_from_lidar);
    last = scan.local_map_from_lidar;
  }
  return chain;
}

/// Bends the chain so that its end is at `end`, evenly along the way: a start near the optimum.
void bend(PoseGraph& chain, const Rigid3& end) {
  const Rigid3 keypose = chain.map_from_node.front();
  const Twist bending =
      log(keypose.inverse() * end * chain.map_from_node.back().inverse() * keypose);
  std::vector<double> way{0.0};
  for (const PoseGraphEdge& edge : chain.edges) {
    way.push_back(way.back() + 1.0 / edge.information(0, 0));
  }
  for (std::size_t i = 1; i < way.size(); ++i) {
    const Rigid3 bent = keypose * exp(way[i] / way.back() * bending);
    chain.map_from_node[i] = bent * (keypose.inverse() * chain.map_from_node[i]);
  }
  chain.map_from_node.back() = end;
}

void append_scans(const std::vector<Rigid3>& nodes, std::vector<Rigid3>& map_from_lidar) {
  map_from_lidar.insert(map_from_lidar.end(), nodes.begin() + 1, nodes.end());
}

}  // namespace

void require_valid(const SpreadOptions& options) {
  require_between("metres_per_sqrt_metre", options.metres_per_sqrt_metre, 1e-6, 1e3);
  require_between("radians_per_sqrt_metre", options.radians_per_sqrt_metre, 1e-6, 1e3);
  require_between("least_way", options.least_way, 1e-6, 1e3);
}

std::vector<Rigid3> spread_corrections(std::span<const ScanPlace> scans,
                                       const std::vector<Rigid3>& keyposes_before,
                                       const std::vector<Rigid3>& keyposes_after,
                                       const SpreadOptions& options) {
  require_valid(options);
  require_same_keyposes(keyposes_before, keyposes_after);
  std::vector<Rigid3> map_from_lidar;
  map_from_lidar.reserve(scans.size());
  std::int64_t last_id = -1;
  while (!scans.empty()) {
    const std::uint32_t id = scans.front().local_map_id;
    if (id >= keyposes_after.size() || id <= last_id) {
      throw Error(Fault::input,
                  "scan " + std::to_string(map_from_lidar.size()) + " is in local map " +
                      std::to_string(id) + ", which is out of order or has no keypose");
    }
    last_id = id;
    const auto own = scans.first(scans_of_first_map(scans));
    scans = scans.subspan(own.size());
    PoseGraph chain = chain_of(own, keyposes_after[id], options);
    if (id + 1 < keyposes_after.size()) {
      const Rigid3 next_from_last =
          keyposes_before[id + 1].inverse() * keyposes_before[id] * own.back().local_map_from_lidar;
      bend(chain, keyposes_after[id + 1] * next_from_last);
      chain.fixed = {0, static_cast<std::uint32_t>(own.size())};
      PoseGraphOptions plain;
      plain.robust = false;
      chain.map_from_node = optimize(chain, plain).map_from_node;
    }
    append_scans(chain.map_from_node, map_from_lidar);
  }
  return map_from_lidar;
}

}  // namespace kissmap
