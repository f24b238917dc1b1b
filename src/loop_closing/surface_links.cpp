// SPDX-License-Identifier: MIT
#include "kissmap/loop_closing/surface_links.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

#include "kissmap/error.hpp"
#include "kissmap/loop_closing/surfel_registration.hpp"

namespace kissmap {
namespace {

constexpr std::size_t most_others = 6;
constexpr std::size_t least_apart = 2;  // stretches between two that a third is linked to
constexpr std::size_t samples = 900;    // surfels of the query
constexpr double least_pairs = 0.3;     // share of the samples
// Of a link between visits, beyond which it is of another map than this.
constexpr double farthest_off = 1.0;  // m
constexpr double most_turned = 0.1;   // rad

struct Pair {
  std::size_t reference = 0;
  std::size_t query = 0;
  friend auto operator<=>(const Pair&, const Pair&) = default;
};

/// Of `query`, with the stretches before it.
void add_pairs(std::span<const StretchPlace> stretches,
               std::span<const Eigen::Vector3d> places,
               std::size_t query,
               std::vector<Pair>& pairs) {
  std::vector<std::pair<double, std::size_t>> near;
  for (std::size_t i = 0; i < query; ++i) {
    const double distance = (places[i] - places[query]).norm();
    const double reach = std::min(stretches[i].mean_range, stretches[query].mean_range);
    if (distance < reach) near.emplace_back(distance, i);
  }
  std::ranges::sort(near);
  std::vector<std::size_t> taken;
  for (const auto& [distance, i] : near) {
    const auto too_close = [i = i](std::size_t other) {
      return (i > other ? i - other : other - i) < least_apart;
    };
    if (std::ranges::any_of(taken, too_close)) continue;
    taken.push_back(i);
    if (taken.size() == most_others) break;
  }
  if (std::ranges::find(taken, query - 1) == taken.end()) taken.push_back(query - 1);
  for (const std::size_t i : taken) pairs.push_back({i, query});
}

std::vector<Pair> pairs_of(std::span<const StretchPlace> stretches,
                           std::span<const Rigid3> map_from_lidar) {
  std::vector<Eigen::Vector3d> places;
  for (const StretchPlace& stretch : stretches) {
    places.push_back(map_from_lidar[stretch.middle_scan].translation);
  }
  std::vector<Pair> pairs;
  for (std::size_t query = 1; query < stretches.size(); ++query) {
    add_pairs(stretches, places, query, pairs);
  }
  std::ranges::sort(pairs);
  return pairs;
}

bool agrees(const SurfaceLink& link, std::span<const Rigid3> map_from_lidar) {
  const Rigid3 off = link.reference_from_query.inverse() *
                     map_from_lidar[link.reference_scan].inverse() *
                     map_from_lidar[link.query_scan];
  return off.translation.norm() < farthest_off && off.angle() < most_turned;
}

}  // namespace

std::vector<SurfaceLink> link_surfaces(std::span<const StretchPlace> stretches,
                                       const std::function<SurfelCloud(std::size_t)>& surfels,
                                       std::span<const SurfaceLink> scan_links,
                                       std::span<const Rigid3> map_from_lidar,
                                       ThreadPool& pool) {
  const std::vector<Pair> pairs = pairs_of(stretches, map_from_lidar);
  std::vector<std::vector<SurfaceLink>> found(stretches.size());
  pool.for_each_chunk(stretches.size(), [&](std::size_t reference) {
    const auto begin = std::ranges::lower_bound(pairs, reference, {}, &Pair::reference);
    const auto end = std::ranges::upper_bound(pairs, reference, {}, &Pair::reference);
    if (begin == end) return;
    const StretchPlace& to = stretches[reference];
    const SurfelMap map(surfels(reference), to.voxel_size);
    for (auto pair = begin; pair != end; ++pair) {
      const StretchPlace& from = stretches[pair->query];
      const Rigid3 guess =
          map_from_lidar[to.middle_scan].inverse() * map_from_lidar[from.middle_scan];
      const SurfelAlignment fit = register_nearby(surfels(pair->query), map, guess, samples);
      if (!fit.converged || fit.pairs < least_pairs * fit.samples) continue;
      found[reference].push_back(
          {to.middle_scan, from.middle_scan, fit.reference_from_query, information_of(fit)});
    }
  });
  std::vector<SurfaceLink> links(scan_links.begin(), scan_links.end());
  for (const auto& part : found) links.insert(links.end(), part.begin(), part.end());
  std::ranges::stable_sort(links, {}, [](const SurfaceLink& link) {
    return std::pair(link.reference_scan, link.query_scan);
  });
  return links;
}

std::vector<Rigid3> fit_surfaces(PoseGraph graph, std::span<const SurfaceLink> links) {
  for (const SurfaceLink& link : links) {
    if (std::max(link.reference_scan, link.query_scan) >= graph.map_from_node.size()) {
      throw input_error("surface links",
                        "name scan " + std::to_string(link.query_scan) + ", which is not there");
    }
    if (!agrees(link, graph.map_from_node)) continue;
    graph.edges.push_back({link.reference_scan,
                           link.query_scan,
                           link.reference_from_query,
                           link.information,
                           EdgeKind::closure});
  }
  return optimize(graph, {}).map_from_node;
}

}  // namespace kissmap
