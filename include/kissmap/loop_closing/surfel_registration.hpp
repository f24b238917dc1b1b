// SPDX-License-Identifier: MIT
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "kissmap/cloud/voxel.hpp"
#include "kissmap/geometry/rigid3.hpp"
#include "kissmap/mapping/local_map.hpp"

namespace kissmap {

/// Surfels of a local map, hashed for finding the nearest one. One surfel a voxel: the first.
/// Blocks of 4^3 voxels are hashed, with a bit for each voxel that holds a surfel, so that a
/// search around a point looks up one to eight of them instead of 27 voxels.
/// Memory: 24 bytes for each slot of a table at most half full, and a copy of the surfels.
/// Reading is thread safe.
class SurfelMap {
 public:
  /// `voxel_size` [m] is also the reach of nearest().
  SurfelMap(const SurfelCloud& surfels, double voxel_size);

  /// What a search found, and how sure it is.
  struct Nearest {
    std::int32_t surfel = -1;  ///< its number; negative if there is none
    float distance = std::numeric_limits<float>::infinity();       ///< m
    float next_distance = std::numeric_limits<float>::infinity();  ///< m, of the second nearest
  };

  /// The surfel nearest to a point among the 27 voxels around it.
  Nearest nearest(const Eigen::Vector3f& point) const;

  /// That a point lies in.
  VoxelKey voxel_at(const Eigen::Vector3f& point) const {
    return voxel_key(voxel_of(point, per_metre_));
  }

  /// True if the voxel of a point holds a surfel.
  bool occupied(const Eigen::Vector3f& point) const;

  const SurfelCloud& surfels() const { return surfels_; }
  double voxel_size() const { return voxel_size_; }

 private:
  struct Block {
    VoxelKey key = no_voxel;    ///< of the block, in blocks
    std::uint64_t voxels = 0;   ///< bit x + 4 y + 16 z: that voxel of the block holds a surfel
    std::uint32_t surfels = 0;  ///< the first one, in the order of the bits
  };
  std::size_t slot_of(VoxelKey block) const;  ///< its own, or the free one where it would go

  SurfelCloud surfels_;
  double voxel_size_;
  float per_metre_;
  unsigned bits_ = 0;
  std::vector<Block> table_;
};

/// Finds the surfels nearest to the same samples again and again. Once these move by little, most
/// are still those found before. Not thread safe.
class NearestSurfels {
 public:
  /// `reference` has to outlive it.
  NearestSurfels(const SurfelMap& reference, std::size_t samples);

  /// The same as reference.nearest(point).surfel, for the place a sample is at now.
  std::int32_t of(std::size_t sample, const Eigen::Vector3f& point);

 private:
  struct Found {
    VoxelKey voxel = no_voxel;  ///< that the search began in
    Eigen::Vector3f point = Eigen::Vector3f::Zero();
    SurfelMap::Nearest nearest;
  };
  bool still_nearest(const Found& found, const Eigen::Vector3f& point) const;

  const SurfelMap& reference_;
  std::vector<Found> found_;
};

/// How two local maps fit together, see register_surfels().
struct SurfelAlignment {
  Rigid3 reference_from_query;
  bool converged = false;  ///< the last update was below 1 mm and 0.1 mrad
  int iterations = 0;
  int pairs = 0;  ///< in the last iteration, of `samples` surfels of the query
  int samples = 0;
  double residual_before = 0.0;  ///< m, RMS distance to planes at the start, of pairs within reach
  double residual_after = 0.0;   ///< m, the same at the end
  /// J'J of the last iteration, twist (translation; rotation) of the query in the query's frame.
  Eigen::Matrix<double, 6, 6> hessian = Eigen::Matrix<double, 6, 6>::Zero();
};

/// A reference made ready for registrations: at the local maps' voxel size and three times as
/// coarse.
class SurfelReference {
 public:
  SurfelReference(const SurfelCloud& surfels, double voxel_size);
  const SurfelMap& fine() const { return fine_; }
  const SurfelMap& coarse() const { return coarse_; }

 private:
  SurfelMap fine_;
  SurfelMap coarse_;
};

/// Point-to-plane registration of surfels (METHOD section 3.6; Chen and Medioni 1991), coarse to
/// fine: pairs within 3 voxels, then within sqrt(3) voxels of each other, at most 45 degrees
/// between their normals, residuals weighted by Geman-McClure. At most 2,500 surfels of the query
/// are used, evenly picked.
SurfelAlignment register_surfels(const SurfelCloud& query,
                                 const SurfelReference& reference,
                                 const Rigid3& guess_reference_from_query);

/// The same from a guess that is good to a voxel or two: at the reference's resolution alone, with
/// at most `samples` surfels of the query. Pairs have to be seen from the same side: the floor of a
/// storey and the ceiling below it are not one surface.
SurfelAlignment register_nearby(const SurfelCloud& query,
                                const SurfelMap& reference,
                                const Rigid3& guess_reference_from_query,
                                std::size_t samples);

/// How well a guess is known, the same in all directions.
struct GuessSigmas {
  double metres = 0.0;
  double radians = 0.0;
};

/// Points to the planes of the reference, which a guess has to lie within a voxel or so of. Where
/// the planes leave a direction open, as along a corridor, the guess decides by its sigmas.
SurfelAlignment register_points(std::span<const Eigen::Vector3f> points_in_query,
                                const SurfelMap& reference,
                                const Rigid3& guess_reference_from_query,
                                const GuessSigmas& sigmas);

/// What an alignment says as an edge of a graph: as if 100 of its pairs were independent and each
/// known to 3 cm. Nothing about directions of translation that less than a twentieth of the
/// planes face: along a bare corridor these are voxels with an edge in them, whose normals are
/// chance.
Eigen::Matrix<double, 6, 6> information_of(const SurfelAlignment& alignment);

/// Szymkiewicz-Simpson coefficient: voxels of the reference that hold a surfel of both maps, over
/// the number of surfels of the smaller map, 0..1.
double overlap(const SurfelCloud& query,
               const SurfelMap& reference,
               const Rigid3& reference_from_query);

}  // namespace kissmap
