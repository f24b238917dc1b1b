// SPDX-License-Identifier: MIT
#include "kissmap/evaluation/trajectory.hpp"

#include <algorithm>
#include <functional>
#include <string>

#include "kissmap/error.hpp"

namespace kissmap {

void require_valid(const Trajectory& trajectory) {
  const auto& stamps = trajectory.stamps_ns;
  if (!stamps.empty() && stamps.size() != trajectory.size()) {
    throw Error(Fault::input,
                std::to_string(stamps.size()) + " stamps for " + std::to_string(trajectory.size()) +
                    " poses; each pose needs one");
  }
  if (std::ranges::adjacent_find(stamps, std::greater{}) != stamps.end()) {
    throw Error(Fault::input, "the stamps of a trajectory fall; sort it by stamp");
  }
  std::int64_t duration = 0;
  if (!stamps.empty() && __builtin_sub_overflow(stamps.back(), stamps.front(), &duration)) {
    throw Error(Fault::input, "the stamps of a trajectory span more than 292 years");
  }
  for (std::size_t i = 0; i < trajectory.size(); ++i) {
    const Rigid3& pose = trajectory.poses[i];
    if (pose.translation.allFinite() && pose.rotation.coeffs().allFinite()) continue;
    throw Error(Fault::input, "pose " + std::to_string(i) + " is not finite; leave it out");
  }
}

std::vector<double> distances_along(const std::vector<Rigid3>& poses) {
  std::vector<double> distances(poses.size(), 0.0);
  for (std::size_t i = 1; i < poses.size(); ++i) {
    distances[i] = distances[i - 1] + (poses[i].translation - poses[i - 1].translation).norm();
  }
  return distances;
}

}  // namespace kissmap
