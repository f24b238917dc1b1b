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
  RayPosition next_y = track.first_y + piece.y_crossed * track.spacing_y;
  RayPosition next_z = track.first_z + piece.z_crossed * track.spacing_z;
  const std::int64_t origin = tile_x << position_bits;
  std::int64_t x_at_y = track.x_at_first_y + piece.y_crossed * track.x_per_y - origin;
  std::int64_t x_at_z = track.x_at_first_z + piece.z_crossed * track.x_per_z - origin;
  const std::int64_t row_step_y = piece.y_falls ? -1 : 1;
  const std::int64_t row_step_z = piece.z_falls ? -tile_side : tile_side;
  std::int64_t row = piece.first_row;
  std::int64_t x = piece.first_x;
  const std::int64_t last_x = piece.last_x;
  for (int i = piece.crossings; i > 0; --i) {
    const bool y_first = next_y <= next_z;
    const std::int64_t to = (y_first ? x_at_y : x_at_z) >> position_bits;
    const std::int64_t until = std::clamp(to, x, last_x);
    mask[static_cast<std::size_t>(row)] |=
        bit_run(static_cast<std::int32_t>(x), static_cast<std::int32_t>(until));
    x = until;
    row += y_first ? row_step_y : row_step_z;
    next_y += y_first ? track.spacing_y : 0;
    x_at_y += y_first ? track.x_per_y : 0;
    next_z += y_first ? 0 : track.spacing_z;
    x_at_z += y_first ? 0 : track.x_per_z;
  }
  mask[static_cast<std::size_t>(row)] |=
      bit_run(static_cast<std::int32_t>(x), static_cast<std::int32_t>(last_x));
}

}  // namespace kissmap::occupancy
