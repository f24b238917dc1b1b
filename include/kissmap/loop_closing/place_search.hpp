// SPDX-License-Identifier: MIT
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "kissmap/loop_closing/descriptor_forest.hpp"
#include "kissmap/loop_closing/place_features.hpp"

namespace kissmap {

struct PlaceSearchOptions {
  int max_distance = 50;   ///< bits between matched descriptors
  int min_inliers = 5;     ///< matches that must agree on a motion
  int skipped_latest = 3;  ///< local maps just before the query are no candidates
  int max_candidates = 5;  ///< best by inliers
};
/// Throws Error(usage) naming the field, its value and its range.
void require_valid(const PlaceSearchOptions& options);

/// An earlier local map that looks like the query from above.
struct PlaceCandidate {
  std::uint32_t id = 0;
  int inliers = 0;
  Rigid3 reference_from_query;  ///< between the local_map frames
};

/// Finds earlier local maps that look like a new one from above (METHOD sections 3.1 to 3.5).
/// Keeps features of all local maps, some 40 kB each. Images are made at two scales, pixels of
/// 0.5 m and, of local maps up to 160 m across, 0.2 m: rooms are too small for the first, streets
/// too large for the second. Same answers on every run. Not thread safe.
class PlaceSearch {
 public:
  explicit PlaceSearch(const PlaceSearchOptions& options);

  /// Takes local maps in order of their ids from 0; `points` in the local_map frame [m]. Returns
  /// the candidates of this one, best first.
  std::vector<PlaceCandidate> add(std::uint32_t id, std::span<const Eigen::Vector3f> points);

 private:
  struct Scale {
    double pixel_size;
    int max_side;
    DescriptorForest forest;
    std::vector<PlaceFeatures> features;  ///< by id
  };

  void search(const Scale& scale,
              std::uint32_t id,
              const PlaceFeatures& query,
              std::vector<PlaceCandidate>& candidates) const;

  PlaceSearchOptions options_;
  std::array<Scale, 2> scales_;
  std::vector<Rigid3> ground_from_local_map_;  ///< by id
};

}  // namespace kissmap
