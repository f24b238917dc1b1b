// SPDX-License-Identifier: MIT
#include "kissmap/loop_closing/loop_closer.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "drift.hpp"

namespace kissmap {
namespace {

constexpr double outline_voxels = 6.0;  // outline voxel over local map voxel
constexpr double min_outline_overlap = 0.3;
// Openings see each other from afar and share few voxels; drift bounds where they can lie.
constexpr ClosureValidationOptions neighbor_validation{0.05, 0.45, 0.01};
constexpr std::size_t looks_per_local_map = 3;  // in each round of the second look
constexpr int max_rounds = 5;
// Of min_wall_agreement, for a closure where odometry expects it, and where it does not: storeys of
// a garage that are alike but for the cars agree by up to 0.68.
constexpr double expected_walls = 0.5;
constexpr double unexpected_walls = 1.17;
// A guess this far from the one tried is another.
constexpr double other_translation = 1.0;  // m
constexpr double other_rotation = 0.2;     // rad

/// Root mean square distance of the surfels from their mean [m].
double extent_of(const SurfelCloud& surfels) {
  const auto count = static_cast<double>(surfels.size());
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  double squares = 0.0;
  for (const Eigen::Vector3f& point : surfels.means) {
    mean += point.cast<double>() / count;
    squares += point.cast<double>().squaredNorm() / count;
  }
  return std::sqrt(std::max(0.0, squares - mean.squaredNorm()));
}

}  // namespace

void require_valid(const LoopClosingOptions& options) {
  require_valid(options.search);
  require_valid(options.validation);
}

LoopCloser::LoopCloser(const LoopClosingOptions& options, double voxel_size, SurfelSource surfels)
    : options_((require_valid(options), options)),
      voxel_size_(voxel_size),
      surfels_(std::move(surfels)),
      search_(options.search) {
}

void LoopCloser::add(const LocalMap& local_map) {
  if (local_map.id == 0) {
    map_from_local_map_.push_back(local_map.map_from_local_map);
  } else {
    const Rigid3 last_from_this =
        odometry_keyposes_.back().inverse() * local_map.map_from_local_map;
    map_from_local_map_.push_back(map_from_local_map_.back() * last_from_this);
  }
  odometry_keyposes_.push_back(local_map.map_from_local_map);
  path_lengths_.push_back(local_map.path_length);
  if (!options_.enabled) return;
  compare_to_neighbor(local_map);
  outlines_.emplace_back(local_map.surfels, outline_voxels * voxel_size_);
  bool found = false;
  for (const PlaceCandidate& candidate : search_.add(local_map.id, local_map.points)) {
    if (!is_new({local_map.id, candidate.id}, candidate.reference_from_query)) continue;
    found |= consider(local_map.surfels,
                      {local_map.id, candidate.id},
                      candidate.reference_from_query,
                      ClosureSource::appearance,
                      candidate.inliers);
  }
  if (found) optimise();
}

void LoopCloser::compare_to_neighbor(const LocalMap& local_map) {
  if (latest_opening_) {
    const std::uint32_t neighbor = local_map.id - 1;
    const Rigid3 guess = odometry_keyposes_[neighbor].inverse() * odometry_keyposes_.back();
    const Closure found =
        validate_closure(local_map.opening, *latest_opening_, guess, neighbor_validation);
    const Rigid3 off = guess.inverse() * found.reference_from_query;
    const double length = path_lengths_[neighbor];
    if (found.verdict == ClosureVerdict::accepted && within_drift(off, length)) {
      neighbors_.push_back({neighbor,
                            found.reference_from_query,
                            latest_opening_scans_ / 2,
                            local_map.opening_scans / 2,
                            extent_of(local_map.opening)});
    }
  }
  latest_opening_.emplace(local_map.opening, voxel_size_);
  latest_opening_scans_ = local_map.opening_scans;
}

bool LoopCloser::is_new(Pair ids, const Rigid3& guess_reference_from_query) {
  const bool closed = std::ranges::any_of(closures_, [ids](const Closure& closure) {
    return enters_graph(closure) && Pair{closure.query_id, closure.reference_id} == ids;
  });
  if (closed) return false;
  const auto [tried, first] = tried_.try_emplace(ids, guess_reference_from_query);
  if (first) return true;
  const Rigid3 off = tried->second.inverse() * guess_reference_from_query;
  if (off.translation.norm() < other_translation && off.angle() < other_rotation) return false;
  tried->second = guess_reference_from_query;
  return true;
}

bool LoopCloser::consider(const SurfelCloud& query,
                          Pair ids,
                          const Rigid3& guess_reference_from_query,
                          ClosureSource source,
                          int inliers) {
  const SurfelReference reference(surfels_(ids.second), voxel_size_);
  Closure closure =
      validate_closure(query, reference, guess_reference_from_query, options_.validation);
  closure.query_id = ids.first;
  closure.reference_id = ids.second;
  closure.source = source;
  closure.inliers = inliers;
  closure.verdict = weigh_against_drift(closure);
  closure.first_verdict = closure.verdict;
  closures_.push_back(closure);
  return closure.verdict == ClosureVerdict::accepted;
}

ClosureVerdict LoopCloser::weigh_against_drift(const Closure& closure) const {
  const bool fits = closure.verdict == ClosureVerdict::accepted;
  // Local maps that are bent themselves do not fit well even where they belong together.
  const double walls = closure.wall_agreement / options_.validation.min_wall_agreement;
  const bool nearly_fits =
      closure.verdict == ClosureVerdict::walls_disagree && walls >= expected_walls;
  if (!fits && !nearly_fits) return closure.verdict;
  const Rigid3 expected =
      map_from_local_map_[closure.reference_id].inverse() * map_from_local_map_[closure.query_id];
  const Rigid3 off = expected.inverse() * closure.reference_from_query;
  const double length =
      drift_length(graph(), path_lengths_, closure.reference_id, closure.query_id);
  if (fits && !within_drift(off, length)) return ClosureVerdict::beyond_drift;
  if (is_expected(off, length)) return ClosureVerdict::accepted;
  return walls >= unexpected_walls ? ClosureVerdict::accepted : ClosureVerdict::walls_disagree;
}

PoseGraph LoopCloser::graph() const {
  PoseGraph graph = keypose_graph(odometry_keyposes_, path_lengths_, closures_);
  graph.map_from_node = map_from_local_map_;
  return graph;
}

LoopEvidence LoopCloser::evidence() const {
  return {odometry_keyposes_, path_lengths_, closures_, neighbors_, {}};
}

void LoopCloser::optimise() {
  const PoseGraphSolution solution = optimize(graph(), {});
  map_from_local_map_ = solution.map_from_node;
  set_verdicts(solution.edge_weights, closures_);
}

void LoopCloser::look_again(const LookProgress& progress) {
  if (!options_.enabled || !options_.second_look) return;
  tried_.clear();  // what was too far from the odometry may not be from the corrected trajectory
  for (int round = 0; round < max_rounds; ++round) {
    bool found = false;
    const auto local_maps = static_cast<std::uint32_t>(map_from_local_map_.size());
    for (std::uint32_t id = 0; id < local_maps; ++id) {
      if (progress) progress(round, id, local_maps);
      found |= look_again_from(id);
    }
    if (!found) return;
    optimise();
  }
}

bool LoopCloser::look_again_from(std::uint32_t query_id) {
  bool found = false;
  SurfelCloud query;
  for (const std::uint32_t reference_id : overlapping(query_id)) {
    const Rigid3 guess =
        map_from_local_map_[reference_id].inverse() * map_from_local_map_[query_id];
    if (!is_new({query_id, reference_id}, guess)) continue;
    if (query.size() == 0) query = surfels_(query_id);
    found |= consider(query, {query_id, reference_id}, guess, ClosureSource::trajectory, 0);
  }
  return found;
}

std::vector<std::uint32_t> LoopCloser::overlapping(std::uint32_t query_id) const {
  std::vector<std::pair<double, std::uint32_t>> overlaps;
  const auto skipped = static_cast<std::uint32_t>(options_.search.skipped_latest);
  for (std::uint32_t id = 0; id + skipped < query_id; ++id) {
    const Rigid3 id_from_query = map_from_local_map_[id].inverse() * map_from_local_map_[query_id];
    const double overlap = outlines_[query_id].overlap(outlines_[id], id_from_query);
    if (overlap >= min_outline_overlap) overlaps.emplace_back(-overlap, id);
  }
  std::ranges::sort(overlaps);
  if (overlaps.size() > looks_per_local_map) overlaps.resize(looks_per_local_map);
  std::vector<std::uint32_t> ids;
  ids.reserve(overlaps.size());
  for (const auto& [overlap, id] : overlaps) ids.push_back(id);
  return ids;
}

}  // namespace kissmap
