// SPDX-License-Identifier: MIT
#include "kissmap/grid/band_mapper.hpp"

#include <algorithm>
#include <cmath>

#include "grid/band_voxels.hpp"
#include "grid/bent_ray.hpp"
#include "options.hpp"

namespace kissmap {
namespace {

constexpr std::size_t rays_per_part = 4096;

int layers_of(const GridBand& band) {
  const double height = band.z_max - band.z_min;
  return std::max(1, static_cast<int>(std::ceil(height / band.resolution - 1e-9)));
}

}  // namespace

void require_valid(const GridBand& band) {
  require_between("z-min", band.z_min, -100.0, 100.0);
  require_between("z-max", band.z_max, -100.0, 100.0);
  require_between("resolution", band.resolution, 0.01, 10.0);
  if (!(band.z_max > band.z_min)) {
    throw usage_error("z-max = " + std::to_string(band.z_max) +
                      " is not above z-min = " + std::to_string(band.z_min));
  }
  if (layers_of(band) > 1000) {
    throw usage_error(
        "the band from z-min to z-max has over 1000 layers; take a coarser resolution");
  }
}

class BandMapper::Impl {
 public:
  Impl(const FloorMap& floor, const GridBand& band, const BandBelief& belief)
      : floor_(floor),
        band_((require_valid(band), band)),
        margin_(belief.free_margin),
        layer_height_((band.z_max - band.z_min) / layers_of(band)),
        voxels_(layers_of(band), belief.log_odds) {}

  void add(const PlacedScan& scan, const Rigid3& level_from_map, ThreadPool& pool) {
    const Rigid3 level_from_lidar = level_from_map * scan.map_from_lidar;
    const std::size_t rays = scan.points.size();
    std::vector<BandScan> parts((rays + rays_per_part - 1) / rays_per_part);
    pool.for_each_chunk(parts.size(), [&](std::size_t part) {
      const std::size_t end = std::min(rays, (part + 1) * rays_per_part);
      for (std::size_t i = part * rays_per_part; i < end; ++i) {
        add_ray(level_from_lidar * scan.origins[i].cast<double>(),
                level_from_lidar * scan.points[i].cast<double>(),
                parts[part]);
      }
    });
    voxels_.add(parts, pool);
  }

  GridMap grid(const ColumnRule& rule) const { return voxels_.grid(band_.resolution, rule); }

 private:
  void add_ray(const Eigen::Vector3d& start, const Eigen::Vector3d& end, BandScan& part) const {
    const double range = (end - start).norm();
    if (!(range > 0.0)) return;
    const bool in_reach = range <= band_.max_range;
    if (in_reach)
      part.hits.push_back(in_band({end.x(), end.y(), end.z() - floor_.height(end.x(), end.y())}));
    const double free = in_reach ? range - margin_ : band_.max_range;
    if (free <= 0.0) return;
    const Eigen::Vector3d last = start + free / range * (end - start);
    if (!may_meet_band(start, last)) return;
    thread_local std::vector<Eigen::Vector3d> corners;
    bend_ray(start, last, floor_, corners);
    for (std::size_t i = 0; i + 1 < corners.size(); ++i) {
      part.free.push_back({in_band(corners[i]), in_band(corners[i + 1])});
    }
  }

  /// False only if the ray is above or below the band wherever the floor may be.
  bool may_meet_band(const Eigen::Vector3d& start, const Eigen::Vector3d& end) const {
    const auto [low, high] = std::minmax(start.z(), end.z());
    return high >= floor_.lowest() + band_.z_min && low <= floor_.highest() + band_.z_max;
  }

  Eigen::Vector3d in_band(const Eigen::Vector3d& above_floor) const {
    return {above_floor.x() / band_.resolution,
            above_floor.y() / band_.resolution,
            (above_floor.z() - band_.z_min) / layer_height_};
  }

  FloorMap floor_;
  GridBand band_;
  double margin_;
  double layer_height_;
  BandVoxels voxels_;
};

BandMapper::BandMapper(const FloorMap& floor, const GridBand& band, const BandBelief& belief)
    : impl_(std::make_unique<Impl>(floor, band, belief)) {
}

BandMapper::~BandMapper() = default;

void BandMapper::add(const PlacedScan& scan, const Rigid3& level_from_map, ThreadPool& pool) {
  impl_->add(scan, level_from_map, pool);
}

GridMap BandMapper::grid(const ColumnRule& rule) const {
  return impl_->grid(rule);
}

}  // namespace kissmap
