// SPDX-License-Identifier: MIT
#include "occupancy/ray_line.hpp"

#include <algorithm>
#include <cmath>

namespace kissmap::occupancy {
namespace {

constexpr double one_voxel = static_cast<double>(std::int64_t{1} << position_bits);

// Far beyond any ray, so that sums of a few never overflow.
constexpr double max_spacing = static_cast<double>(std::int64_t{1} << 23);

RayPosition to_position(double voxels) {
  return static_cast<RayPosition>(voxels * one_voxel);
}

FaceCrossings crossings(double start, double delta, double length) {
  FaceCrossings c;
  const double index = std::floor(start);
  c.start = static_cast<std::int32_t>(index);
  c.step = delta < 0.0 ? -1 : 1;
  const double to_face = delta < 0.0 ? start - index : index + 1.0 - start;
  const double stretch = length / std::abs(delta);
  const double first = to_face * stretch;
  if (!(first <= length)) return c;  // also for no slope at all
  c.first = to_position(first);
  c.spacing = to_position(std::min(stretch, max_spacing));
  c.per_position = 1.0 / static_cast<double>(c.spacing);
  return c;
}

/// First crossing of any face after a position.
RayPosition next_crossing(const RayLine& line, RayPosition position) {
  RayPosition next = never;
  for (const FaceCrossings& axis : line.axes) {
    next = std::min(next, axis.at(axis.count_until(position)));
  }
  return next;
}

/// Last crossing of any face at or before a position; negative if there is none.
RayPosition last_crossing(const RayLine& line, RayPosition position) {
  RayPosition last = -1;
  for (const FaceCrossings& axis : line.axes) {
    const std::int64_t count = axis.count_until(position);
    if (count > 0) last = std::max(last, axis.at(count - 1));
  }
  return last;
}

void clip_to_layers(const LayerRange& layers, RayLine& line) {
  const FaceCrossings& z = line.axes[2];
  const bool rising = z.step > 0;
  const std::int64_t enter =
      rising ? std::int64_t{layers.first} - z.start : std::int64_t{z.start} - layers.last;
  const std::int64_t leave =
      rising ? std::int64_t{layers.last} - z.start : std::int64_t{z.start} - layers.first;
  const std::int64_t crossed = z.count_until(line.carve_to);
  if (leave < 0 || enter > crossed) {
    line.carve_to = line.carve_from - 1;
    return;
  }
  if (enter > 0) line.carve_from = std::max(line.carve_from, z.at(enter - 1));
  if (leave < crossed) line.carve_to = z.at(leave) - 1;
}

}  // namespace

RayLine carved_line(const Eigen::Vector3d& start,
                    const Eigen::Vector3d& end,
                    std::optional<double> protected_share,
                    const std::optional<LayerRange>& layers) {
  const bool turned = end.x() < start.x();
  const Eigen::Vector3d& from = turned ? end : start;
  const Eigen::Vector3d delta =
      turned ? Eigen::Vector3d(start - end) : Eigen::Vector3d(end - start);
  const double length = delta.cwiseAbs().maxCoeff();
  RayLine line;
  for (int axis = 0; axis < 3; ++axis) {
    line.axes[static_cast<std::size_t>(axis)] = crossings(from[axis], delta[axis], length);
  }
  line.start_x = from.x();
  line.slope_x = length > 0.0 ? delta.x() / length : 0.0;
  line.carve_to = to_position(length);
  if (protected_share) {
    const RayPosition kept = to_position(length * *protected_share);
    if (turned) {
      line.carve_from = *protected_share < 1.0 ? next_crossing(line, kept) : never;
    } else {
      line.carve_to = last_crossing(line, line.carve_to - kept) - 1;
    }
  }
  if (layers) clip_to_layers(*layers, line);
  return line;
}

}  // namespace kissmap::occupancy
