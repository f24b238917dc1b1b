// SPDX-License-Identifier: MIT
#include "kissmap/loop_closing/surface_links.hpp"

#include <algorithm>
#include <compare>
#include <iterator>
#include <optional>
#include <string>
#include <utility>

#include "kissmap/error.hpp"
#include "kissmap/loop_closing/surfel_registration.hpp"

namespace kissmap {
namespace {

constexpr std::size_t most_others = 6;
constexpr std::size_t least_apart = 2;  // stretches between two that a third is linked to
constexpr std::size_t samples = 900;    // surfels of the query
constexpr double least_pairs = 0.2;     // share of the samples
// Of a link between visits, beyond which it is of another map than this.
constexpr double farthest_off = 1.5;  // m
constexpr double most_turned = 0.1;   // rad
constexpr int most_passes = 4;        // of agreement, and of graphs
// Of thousands of links few are false, and by little: larger steps find the same ones.
constexpr double growth = 2.0;
constexpr double least_change = 1e-6;  // of a graph's cost
constexpr int most_rounds = 5;
constexpr double least_news = 0.005;  // share of the pairs, for another round
// A pair of stretches off by this lies elsewhere.
constexpr double other_voxels = 0.1;      // of the reference
constexpr double other_rotation = 0.003;  // rad

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

/// By what they show, not by where they were seen from: a narrow view shows a place ahead, which
/// who comes back sees from its other end.
std::vector<Pair> pairs_of(std::span<const StretchPlace> stretches,
                           std::span<const Rigid3> map_from_lidar) {
  std::vector<Eigen::Vector3d> places;
  for (const StretchPlace& stretch : stretches) {
    places.push_back(map_from_lidar[stretch.middle_scan] * stretch.center);
  }
  std::vector<Pair> pairs;
  for (std::size_t query = 1; query < stretches.size(); ++query) {
    add_pairs(stretches, places, query, pairs);
  }
  std::ranges::sort(pairs);
  return pairs;
}

/// What a registration of a pair gave, and where it began.
struct Attempt {
  Pair pair;
  Rigid3 guess_reference_from_query;
  std::optional<SurfaceLink> link;

  /// Where the query was found to be, or else looked for, in the reference's frame.
  const Rigid3& place() const {
    return link ? link->reference_from_query : guess_reference_from_query;
  }
};

/// Pairs of stretches around each other, registered from where a trajectory has them.
class StretchLinker {
 public:
  StretchLinker(std::span<const StretchPlace> stretches,
                const std::function<SurfelCloud(std::size_t)>& surfels,
                ThreadPool& pool)
      : stretches_(stretches), surfels_(surfels), pool_(pool) {}

  /// Registers the pairs that are new, or lie elsewhere than where they were found to be or were
  /// looked for. Returns whether that gave enough new links to matter.
  bool look(std::span<const Rigid3> map_from_lidar) {
    const std::vector<Attempt> before = std::exchange(attempts_, {});
    std::vector<std::size_t> open;
    for (const Pair& pair : pairs_of(stretches_, map_from_lidar)) {
      const Rigid3 guess = map_from_lidar[stretches_[pair.reference].middle_scan].inverse() *
                           map_from_lidar[stretches_[pair.query].middle_scan];
      const Attempt* last = find(before, pair);
      if (last != nullptr && !lies_elsewhere(last->place().inverse() * guess, pair)) {
        attempts_.push_back(*last);
        continue;
      }
      open.push_back(attempts_.size());
      attempts_.push_back({pair, guess, std::nullopt});
    }
    attempt(open);
    const auto news = std::ranges::count_if(open, [&](std::size_t i) {
      return is_news(attempts_[i], find(before, attempts_[i].pair));
    });
    return static_cast<double>(news) > least_news * static_cast<double>(attempts_.size());
  }

  std::vector<SurfaceLink> links() const {
    std::vector<SurfaceLink> found;
    for (const Attempt& attempt : attempts_) {
      if (attempt.link) found.push_back(*attempt.link);
    }
    return found;
  }

 private:
  static const Attempt* find(const std::vector<Attempt>& attempts, const Pair& pair) {
    const auto found = std::ranges::lower_bound(attempts, pair, {}, &Attempt::pair);
    return found != attempts.end() && found->pair == pair ? &*found : nullptr;
  }

  bool lies_elsewhere(const Rigid3& off, const Pair& pair) const {
    return off.translation.norm() > other_voxels * stretches_[pair.reference].voxel_size ||
           off.angle() > other_rotation;
  }

  bool is_news(const Attempt& now, const Attempt* before) const {
    if (!now.link) return false;
    if (before == nullptr || !before->link) return true;
    return lies_elsewhere(before->place().inverse() * now.place(), now.pair);
  }

  /// `open` ascends, as pairs do by their reference: each reference is made ready once.
  void attempt(std::span<const std::size_t> open) {
    std::vector<std::span<const std::size_t>> of_one_reference;
    for (std::size_t begin = 0, i = 1; i <= open.size(); ++i) {
      if (i < open.size() &&
          attempts_[open[i]].pair.reference == attempts_[open[begin]].pair.reference) {
        continue;
      }
      of_one_reference.push_back(open.subspan(begin, i - begin));
      begin = i;
    }
    pool_.for_each_chunk(of_one_reference.size(), [&](std::size_t chunk) {
      const std::size_t reference = attempts_[of_one_reference[chunk].front()].pair.reference;
      const SurfelMap map(surfels_(reference), stretches_[reference].voxel_size);
      for (const std::size_t i : of_one_reference[chunk]) attempt(map, attempts_[i]);
    });
  }

  void attempt(const SurfelMap& reference, Attempt& attempt) const {
    const SurfelAlignment fit = register_nearby(
        surfels_(attempt.pair.query), reference, attempt.guess_reference_from_query, samples);
    if (!fit.converged || fit.pairs < least_pairs * fit.samples) return;
    attempt.link = {stretches_[attempt.pair.reference].middle_scan,
                    stretches_[attempt.pair.query].middle_scan,
                    fit.reference_from_query,
                    information_of(fit)};
  }

  std::span<const StretchPlace> stretches_;
  const std::function<SurfelCloud(std::size_t)>& surfels_;
  ThreadPool& pool_;
  std::vector<Attempt> attempts_;  ///< ascending by pair
};

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
                                       const TrajectoryByLinks& trajectory,
                                       ThreadPool& pool) {
  StretchLinker linker(stretches, surfels, pool);
  std::vector<SurfaceLink> links;
  std::vector<Rigid3> map_from_lidar = trajectory({});
  for (int round = 0; round < most_rounds; ++round) {
    const bool news = linker.look(map_from_lidar);
    if (!news && round > 0) break;
    links.assign(scan_links.begin(), scan_links.end());
    std::ranges::copy(linker.links(), std::back_inserter(links));
    std::ranges::stable_sort(links, {}, [](const SurfaceLink& link) {
      return std::pair(link.reference_scan, link.query_scan);
    });
    map_from_lidar = trajectory(links);
  }
  return links;
}

std::vector<Rigid3> fit_surfaces(PoseGraph graph, std::span<const SurfaceLink> links) {
  for (const SurfaceLink& link : links) {
    if (std::max(link.reference_scan, link.query_scan) < graph.map_from_node.size()) continue;
    throw input_error("surface links",
                      "name scan " + std::to_string(link.query_scan) + ", which is not there");
  }
  PoseGraphOptions options;
  options.min_cost_change = least_change;
  options.growth = growth;
  const std::size_t own_edges = graph.edges.size();
  std::vector<bool> agreed;
  for (int pass = 0; pass < most_passes; ++pass) {
    std::vector<bool> agree;
    for (const SurfaceLink& link : links) agree.push_back(agrees(link, graph.map_from_node));
    if (agree == agreed) break;
    graph.edges.resize(own_edges);
    for (std::size_t i = 0; i < links.size(); ++i) {
      if (!agree[i]) continue;
      graph.edges.push_back({links[i].reference_scan,
                             links[i].query_scan,
                             links[i].reference_from_query,
                             links[i].information,
                             EdgeKind::closure});
    }
    graph.map_from_node = optimize(graph, options).map_from_node;
    agreed = std::move(agree);
  }
  return graph.map_from_node;
}

}  // namespace kissmap
