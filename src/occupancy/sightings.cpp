// SPDX-License-Identifier: MIT
#include "occupancy/sightings.hpp"

#include <Eigen/LU>
#include <bit>
#include <utility>

namespace kissmap::occupancy {
namespace {

constexpr float nearest = 1.3F;          // standard deviations from the mean, of a passage
constexpr float lone_deviation = 0.05F;  // m, of the prior where little was seen around
constexpr float share_of_around = 0.3F;  // of the covariance of what was seen around
constexpr float noise = 0.015F;          // m
constexpr int fewest_around = 4;
constexpr float prior_returns = 0.7F;
constexpr float behind = 0.1F;  // m, that a passage goes on behind the mean

void raise(std::uint16_t& count) {
  if (count != 0xFFFF) ++count;
}

/// Where in its tile the voxel of the lowest bit of a row is.
Eigen::Vector3i place_of_bit(std::size_t row, std::uint64_t bits) {
  const auto r = static_cast<std::int32_t>(row);
  return {std::countr_zero(bits), r % tile_side, r / tile_side};
}

Eigen::Matrix3f matrix_of(const std::array<float, 6>& s) {
  Eigen::Matrix3f matrix;
  matrix << s[0], s[1], s[2], s[1], s[3], s[4], s[2], s[4], s[5];
  return matrix;
}

std::array<float, 6> upper_half_of(const Eigen::Matrix3f& m) {
  return {m(0, 0), m(0, 1), m(0, 2), m(1, 1), m(1, 2), m(2, 2)};
}

/// Welford's updates of mean and covariance, the latter without what lies along the ray.
void add_return(const Eigen::Vector3f& place, const Eigen::Vector3f& ray, Sighting& sighting) {
  const auto n = static_cast<float>(++sighting.returns);
  const Eigen::Vector3f off = place - sighting.mean;
  const Eigen::Vector3f direction = ray.normalized();
  const Eigen::Vector3f across = off - direction.dot(off) * direction;
  const std::array<float, 6> squares = upper_half_of(across * across.transpose());
  for (std::size_t i = 0; i < 6; ++i) {
    sighting.shape[i] += (squares[i] * ((n - 1.0F) / n) - sighting.shape[i]) / n;
  }
  sighting.mean += off / n;
}

}  // namespace

std::size_t Sightings::Block::rank(std::size_t row, std::uint64_t bit) const {
  auto rank = static_cast<std::size_t>(std::popcount(rows[row] & (bit - 1)));
  for (std::size_t k = 0; k < row; ++k) rank += static_cast<std::size_t>(std::popcount(rows[k]));
  return rank;
}

TileMask Sightings::Tile::mask() const {
  TileMask mask{};
  for (std::size_t b = 0; b < blocks.size(); ++b) {
    if (blocks[b] == 0) continue;
    const Block& block = stored[blocks[b] - 1U];
    const std::size_t x = b % 8 * 8;
    const std::size_t row = b / 64 * 8 * tile_side + b / 8 % 8 * 8;
    for (std::size_t k = 0; k < 8; ++k) {
      for (std::size_t j = 0; j < 8; ++j) {
        mask[row + k * tile_side + j] |= (block.rows[k] >> (8 * j) & 0xFFU) << x;
      }
    }
  }
  return mask;
}

Sighting& Sightings::Tile::at(const Eigen::Vector3i& voxel) {
  const Place place = place_of({voxel.x(), voxel.y(), voxel.z()});
  Block& block = stored[blocks[place.block] - 1U];
  return block.sightings[block.rank(place.row, place.bit)];
}

Sightings::Place Sightings::place_of(const Voxel& voxel) {
  const std::int32_t x = inside_tile(voxel.x);
  const std::int32_t y = inside_tile(voxel.y);
  const std::int32_t z = inside_tile(voxel.z);
  return {static_cast<std::size_t>(x / 8 + y / 8 * 8 + z / 8 * 64),
          static_cast<std::size_t>(z % 8),
          std::uint64_t{1} << (x % 8 + y % 8 * 8)};
}

Sightings::Sightings(double voxel_size)
    : geometry_{Eigen::Vector3d::Zero(), Eigen::Vector3d::Constant(voxel_size), std::nullopt},
      caster_(geometry_, {}) {
  require_valid(geometry_);
}

Sighting& Sightings::sighting_at(const Voxel& voxel) {
  auto& tile = tiles_[voxel_key(tile_of(voxel))];
  if (tile == nullptr) tile = std::make_unique<Tile>();
  const Place place = place_of(voxel);
  std::uint16_t& number = tile->blocks[place.block];
  if (number == 0) {
    tile->stored.emplace_back();
    number = static_cast<std::uint16_t>(tile->stored.size());
  }
  Block& block = tile->stored[number - 1U];
  const std::size_t rank = block.rank(place.row, place.bit);
  if ((block.rows[place.row] & place.bit) == 0) {
    block.rows[place.row] |= place.bit;
    block.sightings.insert(block.sightings.begin() + static_cast<std::ptrdiff_t>(rank), Sighting{});
  }
  return block.sightings[rank];
}

void Sightings::add_returns(const RayScan& scan) {
  for (std::size_t i = 0; i < scan.ends.size(); ++i) {
    const Eigen::Vector3d end = scan.offset + scan.ends[i].cast<double>();
    const std::optional<Voxel> voxel = voxel_at(geometry_, end);
    if (!voxel) continue;
    const Eigen::Vector3f place = (end - voxel_center(geometry_, *voxel)).cast<float>();
    add_return(place, scan.ends[i] - scan.starts[i], sighting_at(*voxel));
  }
}

Eigen::Matrix3f Sightings::prior_at(const Voxel& voxel, const Sighting& sighting) const {
  const auto size = static_cast<float>(geometry_.voxel_size.x());
  Eigen::Vector3f sum = Eigen::Vector3f::Zero();
  Eigen::Matrix3f squares = Eigen::Matrix3f::Zero();
  int seen = 0;
  for (std::int32_t z = -1; z <= 1; ++z) {
    for (std::int32_t y = -1; y <= 1; ++y) {
      for (std::int32_t x = -1; x <= 1; ++x) {
        const Sighting* near = at({voxel.x + x, voxel.y + y, voxel.z + z});
        if (near == nullptr) continue;
        const Eigen::Vector3f place =
            near->mean - sighting.mean + size * Eigen::Vector3i(x, y, z).cast<float>();
        sum += place;
        squares += place * place.transpose();
        ++seen;
      }
    }
  }
  if (seen < fewest_around) return lone_deviation * lone_deviation * Eigen::Matrix3f::Identity();
  const auto n = static_cast<float>(seen);
  return share_of_around * (squares / n - sum * sum.transpose() / (n * n)) +
         noise * noise * Eigen::Matrix3f::Identity();
}

void Sightings::settle(ThreadPool& pool) {
  for_each(pool, [this](const Voxel& voxel, Sighting& sighting) {
    const auto n = static_cast<float>(sighting.returns);
    const Eigen::Matrix3f covariance =
        (n * matrix_of(sighting.shape) + prior_returns * prior_at(voxel, sighting)) /
        (n + prior_returns);
    sighting.shape = upper_half_of(covariance.inverse());
  });
}

bool Sightings::passes_through(const Sighting& sighting,
                               const Eigen::Vector3f& centre,
                               const Eigen::Vector3f& direction,
                               float length) const {
  const Eigen::Vector3f mean = centre + sighting.mean;
  if (length - mean.dot(direction) < behind) return false;
  const Eigen::Matrix3f inverse = matrix_of(sighting.shape);
  const Eigen::Vector3f weighted = inverse * mean;
  const float along = direction.dot(weighted);
  return mean.dot(weighted) - along * along / direction.dot(inverse * direction) <=
         nearest * nearest;
}

TileMask Sightings::passages(const Voxel& first,
                             const TileWork& work,
                             std::span<const RayTrack> tracks,
                             const RayScan& scan,
                             Tile& tile,
                             TileMask open) const {
  const Eigen::Vector3f first_centre = (voxel_center(geometry_, first) - scan.offset).cast<float>();
  const auto voxel_size = static_cast<float>(geometry_.voxel_size.x());
  TileMask passed{};
  for (const auto& share : work.pieces) {
    for (const RayPiece& piece : share) {
      const Eigen::Vector3f& start = scan.starts[piece.ray];
      const Eigen::Vector3f way = scan.ends[piece.ray] - start;
      const float length = way.norm();
      const Eigen::Vector3f direction = way / length;
      trace(tracks[piece.ray], piece, first.x, [&](std::size_t row, std::uint64_t run) {
        for (std::uint64_t bits = open[row] & run; bits != 0; bits &= bits - 1) {
          const Eigen::Vector3i place = place_of_bit(row, bits);
          const Eigen::Vector3f centre = first_centre + voxel_size * place.cast<float>() - start;
          if (!passes_through(tile.at(place), centre, direction, length)) continue;
          open[row] &= ~(bits & -bits);
          passed[row] |= bits & -bits;
        }
      });
    }
  }
  return passed;
}

void Sightings::count(VoxelKey key,
                      const TileWork& work,
                      std::span<const RayTrack> tracks,
                      const RayScan& scan,
                      const HitMasks& hits_together,
                      Tile& tile) const {
  TileMask hits{};
  work.mark_hits(hits);
  TileMask open = tile.mask();
  for (std::size_t row = 0; row < open.size(); ++row) hits[row] &= open[row];
  const Voxel number = voxel_from_key(key);
  HitsAround(number, hits_together).leave_out(open);
  const Voxel first{number.x * tile_side, number.y * tile_side, number.z * tile_side};
  const TileMask passed = passages(first, work, tracks, scan, tile, open);
  for (std::size_t row = 0; row < open.size(); ++row) {
    for (std::uint64_t bits = hits[row]; bits != 0; bits &= bits - 1) {
      raise(tile.at(place_of_bit(row, bits)).hits);
    }
    for (std::uint64_t bits = passed[row]; bits != 0; bits &= bits - 1) {
      raise(tile.at(place_of_bit(row, bits)).passages);
    }
  }
}

HitMasks Sightings::hits_of(std::span<const RayScan> scans) const {
  HitMasks hits;
  VoxelKey last = no_voxel;
  TileMask* mask = nullptr;
  for (const RayScan& scan : scans) {
    for (const Eigen::Vector3f& end : scan.ends) {
      const auto voxel = voxel_at(geometry_, scan.offset + end.cast<double>());
      if (!voxel) continue;
      const VoxelKey tile = voxel_key(tile_of(*voxel));
      if (tile != last) mask = &hits[tile];
      last = tile;
      (*mask)[row_of(inside_tile(voxel->y), inside_tile(voxel->z))] |= std::uint64_t{1}
                                                                       << inside_tile(voxel->x);
    }
  }
  return hits;
}

void Sightings::add_rays(std::span<const RayScan> together, ThreadPool& pool) {
  const HitMasks hits = hits_of(together);
  for (const RayScan& scan : together) {
    caster_.cast(
        scan, {}, pool, [&](std::span<const TileWork> work, std::span<const RayTrack> tracks) {
          std::vector<std::pair<const TileWork*, Tile*>> known;
          for (const TileWork& tile : work) {
            const auto found = tiles_.find(tile.tile);
            if (found != tiles_.end()) known.emplace_back(&tile, found->second.get());
          }
          pool.for_each_chunk(known.size(), [&](std::size_t i) {
            const auto& [of_tile, tile] = known[i];
            count(of_tile->tile, *of_tile, tracks, scan, hits, *tile);
          });
        });
  }
}

const Sighting* Sightings::at(const Voxel& voxel) const {
  const auto found = tiles_.find(voxel_key(tile_of(voxel)));
  if (found == tiles_.end()) return nullptr;
  const Place place = place_of(voxel);
  const std::uint16_t number = found->second->blocks[place.block];
  if (number == 0) return nullptr;
  const Block& block = found->second->stored[number - 1U];
  if ((block.rows[place.row] & place.bit) == 0) return nullptr;
  return &block.sightings[block.rank(place.row, place.bit)];
}

Sighting* Sightings::at(const Voxel& voxel) {
  return const_cast<Sighting*>(std::as_const(*this).at(voxel));
}

void Sightings::for_each(ThreadPool& pool,
                         const std::function<void(const Voxel&, Sighting&)>& body) {
  std::vector<std::pair<Voxel, Tile*>> tiles;
  for (const auto& [key, tile] : tiles_) tiles.emplace_back(voxel_from_key(key), tile.get());
  pool.for_each_chunk(tiles.size(), [&](std::size_t i) {
    const auto& [number, tile] = tiles[i];
    for (std::int32_t b = 0; b < 512; ++b) {
      const std::uint16_t stored = tile->blocks[static_cast<std::size_t>(b)];
      if (stored == 0) continue;
      Block& block = tile->stored[stored - 1U];
      std::size_t next = 0;
      for (std::int32_t v = 0; v < 512; ++v) {
        if ((block.rows[static_cast<std::size_t>(v / 64)] >> (v % 64) & 1U) == 0) continue;
        body({number.x * tile_side + b % 8 * 8 + v % 8,
              number.y * tile_side + b / 8 % 8 * 8 + v / 8 % 8,
              number.z * tile_side + b / 64 * 8 + v / 64},
             block.sightings[next++]);
      }
    }
  });
}

}  // namespace kissmap::occupancy
