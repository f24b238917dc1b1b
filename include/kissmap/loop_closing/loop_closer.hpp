// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <utility>
#include <vector>

#include "kissmap/graph/pose_graph.hpp"
#include "kissmap/loop_closing/closure.hpp"
#include "kissmap/loop_closing/closure_validation.hpp"
#include "kissmap/loop_closing/loop_correction.hpp"
#include "kissmap/loop_closing/map_outline.hpp"
#include "kissmap/loop_closing/place_search.hpp"
#include "kissmap/mapping/local_map.hpp"

namespace kissmap {

struct LoopClosingOptions {
  bool enabled = true;
  bool second_look = true;  ///< after the last scan, look along the corrected trajectory
  PlaceSearchOptions search;
  ClosureValidationOptions validation;
};
/// Throws Error(usage) naming the field, its value and its range.
void require_valid(const LoopClosingOptions& options);

/// Closes loops between local maps as they come, and keeps the graph of their keyposes
/// (METHOD section 3). Memory grows with the number of local maps by their features only; surfels
/// are asked for again when a closure is to be validated. Same result on every run. Not thread
/// safe.
class LoopCloser {
 public:
  /// Gives back the surfels of a local map that was added before.
  using SurfelSource = std::function<SurfelCloud(std::uint32_t id)>;

  /// Hears how far a second look is: round from 0, local maps done, of how many.
  using LookProgress =
      std::function<void(int round, std::uint32_t local_maps, std::uint32_t of_local_maps)>;

  /// `voxel_size` [m] is that of the local maps' grids.
  LoopCloser(const LoopClosingOptions& options, double voxel_size, SurfelSource surfels);

  /// Takes local maps in order of their ids from 0, with surfels and points. Looks for closures to
  /// earlier ones and optimises the graph if one is accepted.
  void add(const LocalMap& local_map);

  /// Looks again at pairs of local maps that overlap in the corrected trajectory and were not
  /// matched, until nothing new is found. Call once, last.
  void look_again(const LookProgress& progress = {});

  /// All that was measured: candidates in the order of their validation, neighbours in order of
  /// the query. The verdicts guided the search; correct_loops() has the last word.
  LoopEvidence evidence() const;

 private:
  using Pair = std::pair<std::uint32_t, std::uint32_t>;  ///< query, reference

  /// Whether the pair was not tried from about this guess, and not closed; notes the guess.
  bool is_new(Pair ids, const Rigid3& guess_reference_from_query);
  bool consider(const SurfelCloud& query,
                Pair ids,
                const Rigid3& guess_reference_from_query,
                ClosureSource source,
                int inliers);
  void compare_to_neighbor(const LocalMap& local_map);
  ClosureVerdict weigh_against_drift(const Closure& closure) const;
  PoseGraph graph() const;
  void optimise();
  bool look_again_from(std::uint32_t query_id);
  std::vector<std::uint32_t> overlapping(std::uint32_t query_id) const;

  LoopClosingOptions options_;
  double voxel_size_;
  SurfelSource surfels_;
  PlaceSearch search_;
  std::vector<Rigid3> map_from_local_map_;  ///< corrected so far
  std::vector<Rigid3> odometry_keyposes_;   ///< as the mapper gave them
  std::vector<double> path_lengths_;        ///< m, of each local map
  std::vector<Closure> closures_;
  std::vector<NeighborLink> neighbors_;
  std::optional<SurfelReference> latest_opening_;
  std::uint32_t latest_opening_scans_ = 0;
  std::vector<MapOutline> outlines_;  ///< by id
  std::map<Pair, Rigid3> tried_;      ///< with the latest guess
};

}  // namespace kissmap
