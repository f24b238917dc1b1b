// SPDX-License-Identifier: MIT
#include "kissmap/grid/band_mapper.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "grid/bent_ray.hpp"
#include "grid/column_projection.hpp"
#include "grid/swept_cells.hpp"
#include "occupancy/scan_rays.hpp"
#include "options.hpp"

namespace kissmap {
namespace {

using occupancy::ScanRays;

constexpr std::size_t rays_per_part = 4096;

int layers_of(const GridBand& band) {
  const double height = band.z_max - band.z_min;
  return std::max(1, static_cast<int>(std::ceil(height / band.resolution - 1e-9)));
}

/// Layers that begin and end exactly with the band.
OccupancyGeometry geometry_of(const GridBand& band) {
  const int layers = layers_of(band);
  const double layer_height = (band.z_max - band.z_min) / layers;
  return {{0.0, 0.0, band.z_min},
          {band.resolution, band.resolution, layer_height},
          LayerRange{0, layers - 1}};
}

void append(const ScanRays& part, ScanRays& all) {
  all.starts.insert(all.starts.end(), part.starts.begin(), part.starts.end());
  all.ends.insert(all.ends.end(), part.ends.begin(), part.ends.end());
  all.is_hit.insert(all.is_hit.end(), part.is_hit.begin(), part.is_hit.end());
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
  Impl(const FloorMap& floor,
       const GridBand& band,
       const BandBelief& belief,
       const UprightColumns* upright)
      : floor_(floor),
        upright_(upright),
        band_((require_valid(band), band)),
        belief_((require_between("no-return range", belief.no_return_range, 0.0, 1000.0), belief)),
        voxels_(geometry_of(band), {belief.log_odds}),
        swept_(band.resolution) {}

  void add(const PlacedScan& scan, const Rigid3& level_from_map, ThreadPool& pool) {
    const ScanRays straight =
        occupancy::rays_of(scan, level_from_map * scan.map_from_lidar, belief_.no_return_range);
    const std::size_t rays = straight.starts.size();
    std::vector<ScanRays> parts((rays + rays_per_part - 1) / rays_per_part);
    pool.for_each_chunk(parts.size(), [&](std::size_t part) {
      const std::size_t end = std::min(rays, (part + 1) * rays_per_part);
      parts[part].offset = straight.offset;
      for (std::size_t i = part * rays_per_part; i < end; ++i) {
        bend(straight, i, parts[part]);
      }
    });
    ScanRays bent;
    bent.offset = straight.offset;
    for (const ScanRays& part : parts) append(part, bent);
    voxels_.add(bent.view(), pool);
  }

  void clear_way(const SensorPath& stretch, double half_width) {
    swept_.add(stretch, floor_, half_width);
  }

  GridMap grid(const ColumnRule& rule, const Eigen::AlignedBox2d& area) const {
    return project_columns(voxels_, rule, swept_, area);
  }

  OccupancyMap& voxels() { return voxels_; }

 private:
  /// The free part of a ray as pieces that are no hits, its end as a hit without a way to it.
  void bend(const ScanRays& rays, std::size_t i, ScanRays& bent) const {
    const Eigen::Vector3d start = rays.offset + rays.starts[i].cast<double>();
    const Eigen::Vector3d end = rays.offset + rays.ends[i].cast<double>();
    const double range = (end - start).norm();
    if (!(range > 0.0)) return;
    const bool returned = rays.is_hit[i] != 0;
    if (returned && range <= band_.max_range) {
      const Eigen::Vector3d hit(end.x(), end.y(), end.z() - floor_.height(end.x(), end.y()));
      const bool in_band = hit.z() >= band_.z_min && hit.z() < band_.z_max;
      if (in_band && is_no_floor(end)) push(hit, hit, 1, bent);
    }
    const double margin = returned ? belief_.free_margin : 0.0;
    const double free = std::min(range - margin, band_.max_range);
    if (!(free > 0.0)) return;
    const std::optional<Segment> near =
        part_near_band({start, start + free / range * (end - start)});
    if (!near) return;
    thread_local std::vector<Eigen::Vector3d> corners;
    bend_ray(near->from, near->to, floor_, corners);
    for (std::size_t k = 0; k + 1 < corners.size(); ++k) {
      if (meets_band(corners[k].z(), corners[k + 1].z())) {
        push(corners[k], corners[k + 1], 0, bent);
      }
    }
  }

  /// Of a return in the band.
  bool is_no_floor(const Eigen::Vector3d& hit) const {
    return upright_ == nullptr || floor_.is_seen(hit.x(), hit.y()) || upright_->holds(hit);
  }

  static void push(const Eigen::Vector3d& start,
                   const Eigen::Vector3d& end,
                   std::uint8_t is_hit,
                   ScanRays& rays) {
    rays.starts.emplace_back((start - rays.offset).cast<float>());
    rays.ends.emplace_back((end - rays.offset).cast<float>());
    rays.is_hit.push_back(is_hit);
  }

  /// Of a straight piece between two heights above the floor.
  bool meets_band(double from, double to) const {
    return std::max(from, to) >= band_.z_min && std::min(from, to) <= band_.z_max;
  }

  struct Segment {
    Eigen::Vector3d from, to;
  };

  /// Without what is above or below the band wherever the floor may be.
  std::optional<Segment> part_near_band(const Segment& ray) const {
    const double low = floor_.lowest() + band_.z_min;
    const double high = floor_.highest() + band_.z_max;
    const Eigen::Vector3d way = ray.to - ray.from;
    if (std::abs(way.z()) < 1e-6) {
      return ray.from.z() >= low && ray.from.z() <= high ? std::optional(ray) : std::nullopt;
    }
    const auto [enter, leave] =
        std::minmax({(low - ray.from.z()) / way.z(), (high - ray.from.z()) / way.z()});
    if (enter > 1.0 || leave < 0.0) return std::nullopt;
    return Segment{enter > 0.0 ? ray.from + enter * way : ray.from,
                   leave < 1.0 ? ray.from + leave * way : ray.to};
  }

  FloorMap floor_;
  const UprightColumns* upright_;
  GridBand band_;
  BandBelief belief_;
  OccupancyMap voxels_;
  SweptCells swept_;
};

BandMapper::BandMapper(const FloorMap& floor,
                       const GridBand& band,
                       const BandBelief& belief,
                       const UprightColumns* upright)
    : impl_(std::make_unique<Impl>(floor, band, belief, upright)) {
}

BandMapper::~BandMapper() = default;

void BandMapper::add(const PlacedScan& scan, const Rigid3& level_from_map, ThreadPool& pool) {
  impl_->add(scan, level_from_map, pool);
}

void BandMapper::clear_way(const SensorPath& stretch, double half_width) {
  impl_->clear_way(stretch, half_width);
}

GridMap BandMapper::grid(const ColumnRule& rule, const Eigen::AlignedBox2d& area) const {
  return impl_->grid(rule, area);
}

OccupancyMap& BandMapper::voxels() {
  return impl_->voxels();
}

}  // namespace kissmap
