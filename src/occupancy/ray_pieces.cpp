// SPDX-License-Identifier: MIT
#include "occupancy/ray_pieces.hpp"

#include <cmath>

namespace kissmap::occupancy {
namespace {

constexpr double one_voxel = static_cast<double>(std::int64_t{1} << position_bits);

struct XAtCrossings {
  std::int64_t first = 0;
  std::int64_t step = 0;
};

XAtCrossings x_at(const RayLine& line, const FaceCrossings& axis) {
  if (axis.first == never) return {};
  const double first = line.start_x * one_voxel + line.slope_x * static_cast<double>(axis.first);
  const double step = line.slope_x * static_cast<double>(axis.spacing);
  return {static_cast<std::int64_t>(std::floor(first)), static_cast<std::int64_t>(step)};
}

}  // namespace

RayTrack track_of(const RayLine& line) {
  const FaceCrossings& y = line.axes[1];
  const FaceCrossings& z = line.axes[2];
  const XAtCrossings at_y = x_at(line, y);
  const XAtCrossings at_z = x_at(line, z);
  return {y.first, y.spacing, z.first, z.spacing, at_y.first, at_y.step, at_z.first, at_z.step};
}

void draw(const RayTrack& track, const RayPiece& piece, std::int64_t tile_x, TileMask& mask) {
  trace(track, piece, tile_x, [&mask](std::size_t row, std::uint64_t run) { mask[row] |= run; });
}

}  // namespace kissmap::occupancy
