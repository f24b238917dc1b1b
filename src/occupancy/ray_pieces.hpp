// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <span>

#include "kissmap/cloud/voxel.hpp"
#include "occupancy/ray_line.hpp"
#include "occupancy/tile.hpp"

namespace kissmap::occupancy {

/// What of a RayLine is needed to draw it: crossings of y and z faces, and x there. 64 bytes.
struct RayTrack {
  RayPosition first_y, spacing_y;
  RayPosition first_z, spacing_z;
  std::int64_t x_at_first_y, x_per_y;  ///< voxels * 2^32
  std::int64_t x_at_first_z, x_per_z;
};
RayTrack track_of(const RayLine& line);

/// The part of a ray in one tile.
struct RayPiece {
  std::uint32_t ray;
  std::int32_t y_crossed;   ///< y faces before this tile
  std::int32_t z_crossed;   ///< z faces
  std::uint16_t first_row;  ///< row_of() where it enters
  std::uint8_t crossings;   ///< y and z faces inside the tile, at most 126
  std::uint8_t first_x;     ///< inside the tile, 0..63
  std::uint8_t last_x;
  bool y_falls, z_falls;
};

/// Calls visit(row, bits) for the voxels a piece crosses, run by run along x, in the order in which
/// the ray passes rows. `tile_x` is the tile's first voxel index along x.
template <class Visit>
void trace(const RayTrack& track, const RayPiece& piece, std::int64_t tile_x, Visit&& visit) {
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
    visit(static_cast<std::size_t>(row),
          bit_run(static_cast<std::int32_t>(x), static_cast<std::int32_t>(until)));
    x = until;
    row += y_first ? row_step_y : row_step_z;
    next_y += y_first ? track.spacing_y : 0;
    x_at_y += y_first ? track.x_per_y : 0;
    next_z += y_first ? 0 : track.spacing_z;
    x_at_z += y_first ? 0 : track.x_per_z;
  }
  visit(static_cast<std::size_t>(row),
        bit_run(static_cast<std::int32_t>(x), static_cast<std::int32_t>(last_x)));
}

/// Sets the bits of the voxels a piece crosses.
void draw(const RayTrack& track, const RayPiece& piece, std::int64_t tile_x, TileMask& mask);

/// Cuts the carved part of a ray at tiles, in the order in which it passes them, and calls
/// sink(tile, piece) for each. `ray` goes into the pieces.
template <class Sink>
void cut_at_tiles(const RayLine& line, std::uint32_t ray, Sink&& sink) {
  std::array<std::int64_t, 3> crossed;
  std::array<std::int32_t, 3> index;
  for (std::size_t a = 0; a < 3; ++a) crossed[a] = line.axes[a].count_until(line.carve_from);
  while (true) {
    std::array<std::int64_t, 3> leaving;  // number of the crossing that leaves the tile
    std::array<RayPosition, 3> leaves_at;
    for (std::size_t a = 0; a < 3; ++a) {
      const FaceCrossings& axis = line.axes[a];
      index[a] = axis.index_after(crossed[a]);
      const std::int32_t inside = inside_tile(index[a]);
      leaving[a] = crossed[a] + (axis.step > 0 ? tile_side - 1 - inside : inside);
      leaves_at[a] = axis.at(leaving[a]);
    }
    const RayPosition exit = std::min({leaves_at[0], leaves_at[1], leaves_at[2]});
    const bool last = exit > line.carve_to;
    const RayPosition stop = last ? line.carve_to : exit - 1;
    std::array<std::int64_t, 3> done;  // crossings up to the end of the piece
    for (std::size_t a = 0; a < 3; ++a) {
      done[a] = leaves_at[a] == exit && !last ? leaving[a] : line.axes[a].count_until(stop);
    }
    const Voxel first{index[0], index[1], index[2]};
    sink(tile_of(first),
         RayPiece{ray,
                  static_cast<std::int32_t>(crossed[1]),
                  static_cast<std::int32_t>(crossed[2]),
                  static_cast<std::uint16_t>(row_of(inside_tile(first.y), inside_tile(first.z))),
                  static_cast<std::uint8_t>(done[1] - crossed[1] + done[2] - crossed[2]),
                  static_cast<std::uint8_t>(inside_tile(first.x)),
                  static_cast<std::uint8_t>(inside_tile(line.axes[0].index_after(done[0]))),
                  line.axes[1].step < 0,
                  line.axes[2].step < 0});
    if (last) return;
    for (std::size_t a = 0; a < 3; ++a) {
      crossed[a] = done[a] + (line.axes[a].at(done[a]) == exit ? 1 : 0);
    }
  }
}

}  // namespace kissmap::occupancy
