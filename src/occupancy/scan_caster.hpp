// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "kissmap/occupancy/occupancy_map.hpp"
#include "occupancy/ray_pieces.hpp"
#include "occupancy/tile_groups.hpp"

namespace kissmap::occupancy {

/// A hit in its tile.
struct EndVoxel {
  std::uint32_t ray;
  std::uint16_t row;  ///< row_of()
  std::uint8_t x;
};

/// What a scan does to one tile.
struct TileWork {
  VoxelKey tile = no_voxel;
  std::vector<std::span<const EndVoxel>> hits;    ///< in the order of rays
  std::vector<std::span<const RayPiece>> pieces;  ///< in the order of rays
  std::size_t items = 0;

  void mark_hits(TileMask& mask) const;
  void mark_misses(std::span<const RayTrack> tracks, TileMask& mask) const;
};

/// Turns scans into work on tiles. Keeps its buffers between scans.
class ScanCaster {
 public:
  ScanCaster(const OccupancyGeometry& geometry, const OccupancyOptions& options)
      : geometry_(geometry), options_(options) {}

  /// Calls work(tiles) once or more often; a tile is in one call at most. Outside `box` nothing is
  /// carved, but hits are told. Fills all counts of the update but those of voxels.
  using Work = std::function<void(std::span<const TileWork>, std::span<const RayTrack>)>;
  OccupancyUpdate cast(const RayScan& scan, const TileBox& box, ThreadPool& pool, const Work& work);

 private:
  struct Part {  // rays handled by one thread
    std::size_t begin = 0, end = 0;
    OccupancyUpdate update;
    std::size_t pieces_expected = 0;
    TileGroups<EndVoxel> ends;
    TileGroups<RayPiece> pieces;
  };
  struct IndexRay {
    Eigen::Vector3d start, end;  ///< voxels
  };
  enum class Fate : std::uint8_t { skipped, cast, thinned };

  IndexRay index_ray(const RayScan& scan, std::size_t ray) const;
  Fate judge(const IndexRay& ray, OccupancyUpdate& update) const;
  bool in_layers(std::int32_t z) const;
  std::optional<double> protected_share(const RayScan& scan, std::size_t ray) const;
  void find_ends(const RayScan& scan, Part& part);
  struct Pass {
    std::size_t number, count;
    TileBox box;
  };
  void cut_rays(const RayScan& scan, const Pass& pass, Part& part);
  void thin(std::span<const TileWork> ends, ThreadPool& pool);
  std::vector<TileWork> collect(std::size_t pass, std::size_t passes);

  OccupancyGeometry geometry_;
  OccupancyOptions options_;
  std::vector<Part> parts_;
  std::vector<Fate> fates_;
  std::vector<RayTrack> tracks_;
  TileNumbers numbers_;
};

}  // namespace kissmap::occupancy
