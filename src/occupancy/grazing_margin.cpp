// SPDX-License-Identifier: MIT
#include "kissmap/occupancy/grazing_margin.hpp"

#include <algorithm>
#include <cmath>

#include "kissmap/error.hpp"
#include "occupancy/direction_planes.hpp"
#include "options.hpp"

namespace kissmap {
namespace {

using occupancy::DirectionCell;
using occupancy::DirectionPlane;
using occupancy::DirectionPlanes;

constexpr std::size_t rays_per_chunk = 4096;

struct Ray {
  Eigen::Vector3f start, end, direction;
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

/// m before its end that a ray has to keep clear of a plane; 0 if the plane is not in its way.
float clearance(const Ray& ray,
                const DirectionPlane& plane,
                const Eigen::Vector3f& voxel_size,
                float noise) {
  const float start_height = plane.normal.dot(ray.start) - plane.offset;
  const float side = start_height < 0.0F ? -1.0F : 1.0F;
  const float sine = -side * plane.normal.dot(ray.direction);
  if (!plane.found() || sine <= 0.0F) return 0.0F;
  const float height = side * (plane.normal.dot(ray.end) - plane.offset);
  const float reach = plane.normal.cwiseAbs().dot(voxel_size) + noise;
  // Whoever returns from behind a plane came through a gap in it.
  if (height >= reach || (ray.hit && height < -3.0F * noise)) return 0.0F;
  return (reach - height) / sine;
}

}  // namespace

std::vector<float> grazing_margins(const RayScan& scan,
                                   const Eigen::Vector3d& voxel_size,
                                   const GrazingOptions& options,
                                   ThreadPool& pool) {
  require_between("min_margin", options.min_margin, 0.0, 1e6);
  require_between("surface_noise", options.surface_noise, 1e-6, 1e3);
  const std::size_t count = scan.starts.size();
  if (scan.ends.size() != count || (!scan.is_hit.empty() && scan.is_hit.size() != count)) {
    throw Error(Fault::internal, "arrays of a scan's rays differ in length");
  }
  std::vector<DirectionCell> cells(count);
  const std::size_t chunks = (count + rays_per_chunk - 1) / rays_per_chunk;
  const auto for_each_ray = [&](const auto& body) {
    pool.for_each_chunk(chunks, [&](std::size_t chunk) {
      const std::size_t end = std::min(count, (chunk + 1) * rays_per_chunk);
      for (std::size_t i = chunk * rays_per_chunk; i < end; ++i) body(i);
    });
  };
  for_each_ray([&](std::size_t i) {
    const Ray ray = ray_at(scan, i);
    if (ray.usable()) cells[i] = occupancy::direction_cell(ray.direction);
  });
  std::vector<Eigen::Vector3f> points;
  std::vector<DirectionCell> point_cells;
  std::vector<float> ranges;
  for (std::size_t i = 0; i < count; ++i) {
    const Ray ray = ray_at(scan, i);
    if (!ray.usable() || !ray.hit) continue;
    points.push_back(ray.end);
    point_cells.push_back(cells[i]);
    ranges.push_back(ray.length);
  }
  const DirectionPlanes planes(points, point_cells, ranges, pool);
  std::vector<float> margins(count, 0.0F);
  const Eigen::Vector3f size = voxel_size.cast<float>();
  const auto noise = static_cast<float>(options.surface_noise);
  for_each_ray([&](std::size_t i) {
    const Ray ray = ray_at(scan, i);
    if (!ray.usable()) return;
    float margin = ray.hit ? static_cast<float>(options.min_margin) : 0.0F;
    for (const DirectionPlane* plane : planes.around(cells[i])) {
      margin = std::max(margin, clearance(ray, *plane, size, noise));
    }
    margins[i] = margin;
  });
  return margins;
}

}  // namespace kissmap
