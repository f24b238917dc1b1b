// SPDX-License-Identifier: MIT
#include "kissmap/occupancy/grazing_margin.hpp"

#include <algorithm>
#include <cmath>
#include <span>

#include "kissmap/error.hpp"
#include "occupancy/direction_planes.hpp"
#include "options.hpp"

namespace kissmap {
namespace {

using occupancy::DirectionCell;
using occupancy::DirectionPlane;
using occupancy::DirectionPlanes;

constexpr std::size_t rays_per_chunk = 4096;
constexpr float min_floor_normal = 0.7F;

struct Ray {
  Eigen::Vector3f start, end, direction;  // m, m, unit
  float length = 0.0F;
  bool hit = false;
  bool usable() const { return length > 0.0F && std::isfinite(length); }
};

Ray ray_at(const RayScan& scan, std::size_t i) {
  Ray ray{scan.starts[i], scan.ends[i], scan.ends[i] - scan.starts[i]};
  ray.length = ray.direction.norm();
  ray.direction /= ray.length;
  ray.hit = scan.is_hit.empty() || scan.is_hit[i] != 0;
  return ray;
}

class Clearance {
 public:
  Clearance(const DirectionPlanes& planes, const Eigen::Vector3d& voxel_size, double noise)
      : planes_(planes),
        voxel_size_(voxel_size.cast<float>()),
        noise_(static_cast<float>(noise)),
        tolerance_(3.0F * noise_) {}

  /// m before its end that a ray has to keep clear of the planes around it.
  float of(const Ray& ray, const DirectionCell& cell) const {
    float clearance = 0.0F;
    bool explained = false;  // the ray ends on a plane; larger cells would only blur it
    for (int level = 0; level < DirectionPlanes::levels && !explained; ++level) {
      for (const DirectionPlane* plane : planes_.around(level, cell)) {
        if (!plane->found()) continue;
        const auto [needed, on_plane] = of(ray, *plane);
        clearance = std::max(clearance, needed);
        explained = explained || on_plane;
      }
    }
    return clearance;
  }

 private:
  struct FromPlane {
    float needed = 0.0F;
    bool on_plane = false;
  };

  FromPlane of(const Ray& ray, const DirectionPlane& plane) const {
    const float start_height = plane.normal.dot(ray.start) - plane.offset;
    const float side = start_height < 0.0F ? -1.0F : 1.0F;
    const float sine = -side * plane.normal.dot(ray.direction);
    const float height = side * (plane.normal.dot(ray.end) - plane.offset);
    const bool on_plane = ray.hit && std::abs(height) <= tolerance_;
    if (sine <= 0.0F) return {0.0F, on_plane};
    // What returns from behind a plane came through a gap in it. What does not return may have gone
    // into a floor, but hardly into a wall.
    const bool may_end_behind = !ray.hit && side * plane.normal.z() > min_floor_normal;
    const float reach = plane.normal.cwiseAbs().dot(voxel_size_) + noise_;
    if (height >= reach || (height < -tolerance_ && !may_end_behind)) return {0.0F, on_plane};
    return {(reach - height) / sine, on_plane};
  }

  const DirectionPlanes& planes_;
  Eigen::Vector3f voxel_size_;
  float noise_;
  float tolerance_;
};

void require_valid(const RayScan& scan, const GrazingOptions& options) {
  require_between("min_margin", options.min_margin, 0.0, 1e6);
  require_between("surface_noise", options.surface_noise, 1e-6, 1e3);
  const std::size_t count = scan.starts.size();
  if (scan.ends.size() != count || (!scan.is_hit.empty() && scan.is_hit.size() != count)) {
    throw Error(Fault::internal, "arrays of a scan's rays differ in length");
  }
}

DirectionPlanes planes_of(std::span<const Ray> rays,
                          std::span<const DirectionCell> cells,
                          ThreadPool& pool) {
  std::vector<Eigen::Vector3f> points;
  std::vector<DirectionCell> point_cells;
  std::vector<float> ranges;
  for (std::size_t i = 0; i < rays.size(); ++i) {
    if (!rays[i].usable() || !rays[i].hit) continue;
    points.push_back(rays[i].end);
    point_cells.push_back(cells[i]);
    ranges.push_back(rays[i].length);
  }
  return {points, point_cells, ranges, pool};
}

}  // namespace

std::vector<float> grazing_margins(const RayScan& scan,
                                   const Eigen::Vector3d& voxel_size,
                                   const GrazingOptions& options,
                                   ThreadPool& pool) {
  require_valid(scan, options);
  const std::size_t count = scan.starts.size();
  const auto for_each_ray = [&](const auto& body) {
    pool.for_each_chunk((count + rays_per_chunk - 1) / rays_per_chunk, [&](std::size_t chunk) {
      const std::size_t end = std::min(count, (chunk + 1) * rays_per_chunk);
      for (std::size_t i = chunk * rays_per_chunk; i < end; ++i) body(i);
    });
  };
  std::vector<Ray> rays(count);
  std::vector<DirectionCell> cells(count);
  for_each_ray([&](std::size_t i) {
    rays[i] = ray_at(scan, i);
    if (rays[i].usable()) cells[i] = occupancy::direction_cell(rays[i].direction);
  });
  const DirectionPlanes planes = planes_of(rays, cells, pool);
  const Clearance clearance(planes, voxel_size, options.surface_noise);
  std::vector<float> margins(count, 0.0F);
  for_each_ray([&](std::size_t i) {
    if (!rays[i].usable()) return;
    const float least = rays[i].hit ? static_cast<float>(options.min_margin) : 0.0F;
    margins[i] = std::max(least, clearance.of(rays[i], cells[i]));
  });
  return margins;
}

}  // namespace kissmap
