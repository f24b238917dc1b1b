// SPDX-License-Identifier: MIT
#include "kissmap/loop_closing/place_search.hpp"

#include <algorithm>
#include <map>

#include "kissmap/loop_closing/density_image.hpp"
#include "kissmap/loop_closing/ground_alignment.hpp"
#include "kissmap/loop_closing/planar_alignment.hpp"
#include "options.hpp"

namespace kissmap {
namespace {

constexpr double inlier_pixels = 3.0;
constexpr std::size_t max_aligned = 20;  // places with the most matches

using PairsByPlace = std::map<std::uint32_t, std::vector<PlanarPair>>;

/// Places with at least `fewest` matches; if they are many, those with the most.
std::vector<std::uint32_t> best_matched(const PairsByPlace& pairs, std::size_t fewest) {
  std::vector<std::uint32_t> places;
  for (const auto& [place, matched] : pairs) {
    if (matched.size() >= fewest) places.push_back(place);
  }
  std::ranges::stable_sort(places, std::ranges::greater{}, [&pairs](std::uint32_t place) {
    return pairs.at(place).size();
  });
  if (places.size() > max_aligned) places.resize(max_aligned);
  return places;
}

}  // namespace

void require_valid(const PlaceSearchOptions& options) {
  require_between("max_descriptor_distance", options.max_distance, 0, 256);
  require_between("min_inliers", options.min_inliers, 2, 500);
  require_between("skipped_local_maps", options.skipped_latest, 1, 1000);
  require_between("max_candidates", options.max_candidates, 1, 100);
}

PlaceSearch::PlaceSearch(const PlaceSearchOptions& options)
    : options_((require_valid(options), options)),
      scales_{Scale{0.5, 4000, {}, {}}, Scale{0.2, 800, {}, {}}} {
}

std::vector<PlaceCandidate> PlaceSearch::add(std::uint32_t id,
                                             std::span<const Eigen::Vector3f> points) {
  // Without a ground the frame of the local map is as good a guess as any.
  ground_from_local_map_.push_back(ground_from_local_map(points).value_or(Rigid3{}));
  std::vector<PlaceCandidate> candidates;
  for (Scale& scale : scales_) {
    const DensityImage image =
        density_image(points, ground_from_local_map_.back(), scale.pixel_size, scale.max_side);
    scale.features.push_back(place_features(image));
    search(scale, id, scale.features.back(), candidates);
    scale.forest.add(id, scale.features.back().descriptors);
  }
  std::ranges::stable_sort(candidates, std::ranges::greater{}, &PlaceCandidate::inliers);
  if (candidates.size() > static_cast<std::size_t>(options_.max_candidates)) {
    candidates.resize(static_cast<std::size_t>(options_.max_candidates));
  }
  return candidates;
}

void PlaceSearch::search(const Scale& scale,
                         std::uint32_t id,
                         const PlaceFeatures& query,
                         std::vector<PlaceCandidate>& candidates) const {
  const auto skipped = static_cast<std::uint32_t>(options_.skipped_latest);
  if (id < skipped) return;
  PairsByPlace pairs;
  for (std::size_t i = 0; i < query.size(); ++i) {
    for (const DescriptorForest::Match& match :
         scale.forest.search(query.descriptors[i], options_.max_distance, id - skipped)) {
      const PlaceFeatures& reference = scale.features[match.entry.place];
      pairs[match.entry.place].push_back(
          {query.positions[i], reference.positions[match.entry.feature]});
    }
  }
  for (const std::uint32_t place :
       best_matched(pairs, static_cast<std::size_t>(options_.min_inliers))) {
    const std::uint64_t seed = (std::uint64_t{id} << 32U) + place;
    const auto alignment = align_planar(pairs.at(place), inlier_pixels * scale.pixel_size, seed);
    if (!alignment || alignment->inliers < options_.min_inliers) continue;
    candidates.push_back(
        {place,
         alignment->inliers,
         ground_from_local_map_[place].inverse() * alignment->reference_from_query.in_space() *
             ground_from_local_map_[id]});
  }
}

}  // namespace kissmap
