// SPDX-License-Identifier: MIT
#include "kissmap/evaluation/kitti_error.hpp"

#include <algorithm>

#include "kissmap/error.hpp"
#include "kissmap/evaluation/trajectory.hpp"
#include "options.hpp"

namespace kissmap {
namespace {

void add(KittiMean& sum, double translation, double rotation) {
  ++sum.segments;
  sum.translation += translation;
  sum.rotation += rotation;
}

void divide(KittiMean& sum) {
  if (sum.segments == 0) return;
  sum.translation /= static_cast<double>(sum.segments);
  sum.rotation /= static_cast<double>(sum.segments);
}

}  // namespace

void require_valid(const KittiOptions& options) {
  constexpr double shortest = 1e-3;
  constexpr double longest = 1e6;
  if (options.lengths.empty()) throw usage_error("the KITTI error needs lengths of segments");
  for (const double length : options.lengths) {
    require_between("a length of segments", length, shortest, longest);
  }
  if (options.step == 0) throw usage_error("the step of the KITTI error must be 1 or more poses");
}

std::vector<double> kitti_lengths_for(double path_length) {
  constexpr double long_way = 200.0;  // m
  constexpr double short_way = 20.0;
  if (path_length >= long_way) return KittiOptions{}.lengths;
  std::vector<double> lengths;
  for (int i = 1; i <= 10; ++i) lengths.push_back(path_length >= short_way ? i : i / 10.0);
  return lengths;
}

KittiError kitti_error(const std::vector<Rigid3>& reference,
                       const std::vector<Rigid3>& estimate,
                       const KittiOptions& options) {
  require_valid(options);
  const std::vector<double> distances = distances_along(reference);
  KittiError error;
  for (const double length : options.lengths) {
    KittiMean mean{length};
    for (std::size_t first = 0; first < reference.size(); first += options.step) {
      const auto end = std::ranges::upper_bound(distances, distances[first] + length);
      if (end == distances.end()) break;
      const auto last = static_cast<std::size_t>(end - distances.begin());
      const Rigid3 true_motion = reference[first].inverse() * reference[last];
      const Rigid3 motion = estimate[first].inverse() * estimate[last];
      const Rigid3 difference = motion.inverse() * true_motion;
      const double translation = difference.translation.norm() / length;
      add(mean, translation, difference.angle() / length);
      add(error.overall, translation, difference.angle() / length);
    }
    divide(mean);
    error.lengths.push_back(mean);
  }
  divide(error.overall);
  return error;
}

}  // namespace kissmap
