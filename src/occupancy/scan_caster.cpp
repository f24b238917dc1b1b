// SPDX-License-Identifier: MIT
#include "occupancy/scan_caster.hpp"

#include <algorithm>
#include <cmath>

#include "kissmap/error.hpp"

namespace kissmap::occupancy {
namespace {

constexpr std::size_t rays_per_part = 4096;
constexpr std::size_t bytes_per_piece = 2 * sizeof(RayPiece) + 4;

std::size_t pass_of(VoxelKey tile, std::size_t passes) {
  return passes == 1 ? 0 : voxel_hash(tile, 32) % passes;
}

Voxel floor_of(const Eigen::Vector3d& position) {
  return {static_cast<std::int32_t>(std::floor(position.x())),
          static_cast<std::int32_t>(std::floor(position.y())),
          static_cast<std::int32_t>(std::floor(position.z()))};
}

bool is_hit(const RayScan& scan, std::size_t ray) {
  return scan.is_hit.empty() || scan.is_hit[ray] != 0;
}

std::size_t tiles_crossed(const Voxel& start, const Voxel& end) {
  const Voxel a = tile_of(start);
  const Voxel b = tile_of(end);
  return static_cast<std::size_t>(std::abs(a.x - b.x) + std::abs(a.y - b.y) + std::abs(a.z - b.z)) +
         1;
}

/// False if the straight way between two tiles is outside, by more than rounding can bend it.
bool may_touch(const TileBox& box, const Voxel& a, const Voxel& b) {
  return std::max(a.x, b.x) + 1 >= box.x_first && std::min(a.x, b.x) - 1 < box.x_end &&
         std::max(a.y, b.y) + 1 >= box.y_first && std::min(a.y, b.y) - 1 < box.y_end;
}

void require_consistent(const RayScan& scan) {
  const std::size_t n = scan.starts.size();
  const auto parallel = [n](std::size_t size) { return size == 0 || size == n; };
  if (scan.ends.size() != n || !parallel(scan.is_hit.size()) || !parallel(scan.margins.size())) {
    throw Error(Fault::internal, "arrays of a scan's rays differ in length");
  }
  if (!(scan.margin >= 0.0)) throw Error(Fault::internal, "margin of rays is negative or NaN");
  if (!scan.offset.allFinite()) throw Error(Fault::internal, "offset of rays is not finite");
}

}  // namespace

void TileWork::mark_hits(TileMask& mask) const {
  for (const auto& share : hits) {
    for (const EndVoxel& end : share) mask[end.row] |= std::uint64_t{1} << end.x;
  }
}

void TileWork::mark_misses(std::span<const RayTrack> tracks, TileMask& mask) const {
  const std::int64_t tile_x = std::int64_t{voxel_from_key(tile).x} * tile_side;
  for (const auto& share : pieces) {
    for (const RayPiece& piece : share) draw(tracks[piece.ray], piece, tile_x, mask);
  }
}

OccupancyUpdate ScanCaster::cast(const RayScan& scan,
                                 const TileBox& box,
                                 ThreadPool& pool,
                                 const Work& work) {
  require_consistent(scan);
  const std::size_t rays = scan.starts.size();
  fates_.assign(rays, Fate::skipped);
  tracks_.resize(rays);
  parts_.resize((rays + rays_per_part - 1) / rays_per_part);
  pool.for_each_chunk(parts_.size(), [&](std::size_t p) {
    parts_[p].begin = p * rays_per_part;
    parts_[p].end = std::min(rays, (p + 1) * rays_per_part);
    find_ends(scan, parts_[p]);
  });
  if (options_.one_ray_per_end_voxel) thin(collect(0, 1), pool);
  OccupancyUpdate update;
  std::size_t pieces = 0;
  for (const Part& part : parts_) {
    update.non_finite += part.update.non_finite;
    update.too_far += part.update.too_far;
    pieces += part.pieces_expected;
  }
  update.rays = rays;
  update.thinned = static_cast<std::uint64_t>(std::ranges::count(fates_, Fate::thinned));
  const std::size_t passes =
      1 + pieces * bytes_per_piece / std::max<std::size_t>(1, options_.scratch_bytes);
  for (std::size_t pass = 0; pass < passes; ++pass) {
    pool.for_each_chunk(parts_.size(), [&](std::size_t p) {
      cut_rays(scan, {pass, passes, box}, parts_[p]);
    });
    work(collect(pass, passes), tracks_);
  }
  return update;
}

ScanCaster::IndexRay ScanCaster::index_ray(const RayScan& scan, std::size_t ray) const {
  const Eigen::Array3d origin = (scan.offset - geometry_.origin).array();
  const Eigen::Array3d size = geometry_.voxel_size.array();
  return {(origin + scan.starts[ray].cast<double>().array()) / size,
          (origin + scan.ends[ray].cast<double>().array()) / size};
}

ScanCaster::Fate ScanCaster::judge(const IndexRay& ray, OccupancyUpdate& update) const {
  if (!ray.start.allFinite() || !ray.end.allFinite()) {
    ++update.non_finite;
    return Fate::skipped;
  }
  const double farthest = std::max(ray.start.cwiseAbs().maxCoeff(), ray.end.cwiseAbs().maxCoeff());
  const double longest = (ray.end - ray.start).cwiseAbs().maxCoeff();
  if (farthest < max_voxel_index - 1 && longest < max_ray_voxels) return Fate::cast;
  ++update.too_far;
  return Fate::skipped;
}

bool ScanCaster::in_layers(std::int32_t z) const {
  return !geometry_.layers || (z >= geometry_.layers->first && z <= geometry_.layers->last);
}

std::optional<double> ScanCaster::protected_share(const RayScan& scan, std::size_t ray) const {
  const bool hit = is_hit(scan, ray);
  const double margin = !scan.margins.empty() ? scan.margins[ray] : hit ? scan.margin : 0.0;
  if (std::isnan(margin)) return 1.0;
  if (margin <= 0.0) return hit ? std::optional(0.0) : std::nullopt;
  const double length = (scan.ends[ray] - scan.starts[ray]).cast<double>().norm();
  return margin < length ? margin / length : 1.0;
}

void ScanCaster::find_ends(const RayScan& scan, Part& part) {
  part.update = {};
  part.pieces_expected = 0;
  part.ends.clear();
  part.pieces.clear();
  for (std::size_t i = part.begin; i < part.end; ++i) {
    const IndexRay ray = index_ray(scan, i);
    fates_[i] = judge(ray, part.update);
    if (fates_[i] == Fate::skipped) continue;
    const Voxel end = floor_of(ray.end);
    part.pieces_expected += tiles_crossed(floor_of(ray.start), end);
    if (!is_hit(scan, i) || !in_layers(end.z)) continue;
    part.ends.add(voxel_key(tile_of(end)),
                  {static_cast<std::uint32_t>(i),
                   static_cast<std::uint16_t>(row_of(inside_tile(end.y), inside_tile(end.z))),
                   static_cast<std::uint8_t>(inside_tile(end.x))});
  }
  part.ends.gather();
}

void ScanCaster::cut_rays(const RayScan& scan, const Pass& pass, Part& part) {
  part.pieces.clear();
  for (std::size_t i = part.begin; i < part.end; ++i) {
    if (fates_[i] != Fate::cast) continue;
    const IndexRay ray = index_ray(scan, i);
    const Voxel first = floor_of(ray.start);
    const Voxel last = floor_of(ray.end);
    if (first == last && is_hit(scan, i)) continue;  // a hit does not carve the voxel it ends in
    if (!may_touch(pass.box, tile_of(first), tile_of(last))) continue;
    const RayLine line =
        carved_line(ray.start, ray.end, protected_share(scan, i), geometry_.layers);
    if (!line.carves()) continue;
    tracks_[i] = track_of(line);
    cut_at_tiles(line, static_cast<std::uint32_t>(i), [&](const Voxel& tile, const RayPiece& p) {
      const VoxelKey key = voxel_key(tile);
      if (pass_of(key, pass.count) == pass.number && pass.box.contains(tile)) {
        part.pieces.add(key, p);
      }
    });
  }
  part.pieces.gather();
}

void ScanCaster::thin(std::span<const TileWork> ends, ThreadPool& pool) {
  pool.for_each_chunk(ends.size(), [&](std::size_t t) {
    TileMask seen{};
    for (const auto& share : ends[t].hits) {
      for (const EndVoxel& end : share) {
        const std::uint64_t bit = std::uint64_t{1} << end.x;
        if ((seen[end.row] & bit) != 0) fates_[end.ray] = Fate::thinned;
        seen[end.row] |= bit;
      }
    }
  });
}

std::vector<TileWork> ScanCaster::collect(std::size_t pass, std::size_t passes) {
  numbers_.clear();
  std::vector<TileWork> work;
  const auto of_tile = [&](VoxelKey tile) -> TileWork& {
    const std::uint32_t number = numbers_.number(tile);
    if (number == work.size()) work.emplace_back().tile = tile;
    return work[number];
  };
  for (const Part& part : parts_) {
    for (std::size_t t = 0; t < part.ends.tiles().size(); ++t) {
      if (pass_of(part.ends.tiles()[t], passes) != pass) continue;
      TileWork& tile = of_tile(part.ends.tiles()[t]);
      tile.hits.push_back(part.ends.of_tile(t));
      tile.items += tile.hits.back().size();
    }
    for (std::size_t t = 0; t < part.pieces.tiles().size(); ++t) {
      TileWork& tile = of_tile(part.pieces.tiles()[t]);
      tile.pieces.push_back(part.pieces.of_tile(t));
      tile.items += tile.pieces.back().size();
    }
  }
  // The largest first, so that no thread is left with one at the end.
  std::ranges::stable_sort(work, std::ranges::greater{}, &TileWork::items);
  return work;
}

}  // namespace kissmap::occupancy
