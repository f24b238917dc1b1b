// SPDX-License-Identifier: MIT
#include "simulator/plan_truth.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "kissmap/error.hpp"
#include "simulator/convex_polygon.hpp"

namespace kissmap::simulator {
namespace {

using Eigen::AlignedBox2d;
using Eigen::Vector2d;
using Eigen::Vector3d;
constexpr double border = 1e-9;  // m; what overlaps less only borders

AlignedBox2d box_around(const ConvexPolygon& polygon) {
  AlignedBox2d box;
  for (const Vector2d& corner : polygon) box.extend(corner);
  return box;
}

// First and last cell that share more than a border with [low, high], in cells from the corner.
std::pair<int, int> cell_span(double low, double high, double origin, double resolution, int end) {
  const auto first = std::floor((low + border - origin) / resolution);
  const auto last = std::ceil((high - border - origin) / resolution) - 1.0;
  return {static_cast<int>(std::clamp(first, 0.0, static_cast<double>(end))),
          static_cast<int>(std::clamp(last, -1.0, end - 1.0))};
}

// The floor's piece seen with its floor level: heights are those above the floor.
Vector3d above_floor(const FloorPiece& piece, const Vector3d& p) {
  return {p.x(), p.y(), p.z() - piece.height_at(p.head<2>())};
}

class BandRaster {
 public:
  BandRaster(const PlanFrame& frame, const FloorBand& band) : band_(band) {
    truth_.frame = frame;
    truth_.classes.assign(frame.size(), 0);
  }

  void add(const Primitive& solid, const FloorPiece& piece) {
    bit_ = 1U << static_cast<unsigned>(solid.object_class);
    if (solid.shape == Shape::box) {
      fill(clipped(convex_hull(box_in_band(solid, piece)), piece.area));
    } else {
      fill_cylinder(solid, piece);
    }
  }

  PlanTruth take() { return std::move(truth_); }

 private:
  // A box with level floor and the band's two planes cut from it: where its edges meet the planes,
  // and its corners between them. Seen from above, their hull is the shadow of the part inside.
  std::vector<Vector2d> box_in_band(const Primitive& solid, const FloorPiece& piece) const {
    std::array<Vector3d, 8> corners;
    for (unsigned k = 0; k < 8; ++k) {
      Vector3d corner = solid.half_extents;
      for (const int axis : {0, 1, 2}) corner[axis] *= (k >> axis & 1U) != 0 ? 1.0 : -1.0;
      corner.z() += solid.slope.dot(corner.head<2>());
      corners[k] = above_floor(piece, solid.world_from_object * corner);
    }
    std::vector<Vector2d> shadow;
    const double low = band_.z_min + border;
    const double high = band_.z_max - border;
    for (unsigned a = 0; a < 8; ++a) {
      if (corners[a].z() >= low && corners[a].z() <= high) {
        shadow.emplace_back(corners[a].head<2>());
      }
      for (unsigned axis = 0; axis < 3; ++axis) {
        const unsigned b = a | 1U << axis;
        if (b == a) continue;
        for (const double plane : {low, high}) {
          const double from = corners[a].z() - plane;
          const double to = corners[b].z() - plane;
          if (from * to >= 0.0) continue;
          shadow.emplace_back(
              (corners[a] + from / (from - to) * (corners[b] - corners[a])).head<2>());
        }
      }
    }
    return shadow;
  }

  // A convex shape cut to a row of cells spans what its corners span along that row.
  void fill(const ConvexPolygon& shadow) {
    const PlanFrame& frame = truth_.frame;
    const AlignedBox2d box = box_around(shadow);
    if (shadow.size() < 3) return;
    const auto [first, last] =
        cell_span(box.min().y(), box.max().y(), frame.lower_left.y(), frame.resolution, frame.rows);
    for (int row = first; row <= last; ++row) {
      const double low = frame.corner(0, row).y();
      const ConvexPolygon part =
          clipped(clipped(shadow, Vector2d(0, -1), -low), Vector2d(0, 1), low + frame.resolution);
      const AlignedBox2d span = box_around(part);
      if (part.empty() || span.sizes().y() < border) continue;
      const auto [from, to] = cell_span(
          span.min().x(), span.max().x(), frame.lower_left.x(), frame.resolution, frame.columns);
      for (int column = from; column <= to; ++column)
        truth_.classes[frame.index(column, row)] |= bit_;
    }
  }

  // An upright cylinder fills a circle, cut where a sloping band passes its caps.
  void fill_cylinder(const Primitive& solid, const FloorPiece& piece) {
    const PlanFrame& frame = truth_.frame;
    const Vector3d axis = solid.world_from_object.rotation * Vector3d::UnitZ();
    if (axis.head<2>().norm() > 1e-12) {
      throw usage_error("plan truth: a static cylinder does not stand upright");
    }
    const Vector2d middle = solid.world_from_object.translation.head<2>();
    const double radius = solid.half_extents.x();
    const double foot = solid.world_from_object.translation.z() - solid.half_extents.z();
    const double top = solid.world_from_object.translation.z() + solid.half_extents.z();
    const double level = piece.height - piece.slope.dot(piece.area.min());
    const auto [left, right] = cell_span(middle.x() - radius,
                                         middle.x() + radius,
                                         frame.lower_left.x(),
                                         frame.resolution,
                                         frame.columns);
    const auto [low, high] = cell_span(middle.y() - radius,
                                       middle.y() + radius,
                                       frame.lower_left.y(),
                                       frame.resolution,
                                       frame.rows);
    for (int row = low; row <= high; ++row) {
      for (int column = left; column <= right; ++column) {
        const AlignedBox2d cell(frame.corner(column, row), frame.corner(column + 1, row + 1));
        ConvexPolygon part = clipped(rectangle(cell), piece.area);
        part = clipped(part, piece.slope, top - border - band_.z_min - level);
        part = clipped(part, -piece.slope, level + band_.z_max - foot - border);
        if (part.empty() || box_around(part).sizes().minCoeff() < border) continue;
        if (distance(part, middle) < radius - border) {
          truth_.classes[frame.index(column, row)] |= bit_;
        }
      }
    }
  }

  FloorBand band_;
  PlanTruth truth_;
  std::uint32_t bit_ = 0;
};

// Shortens [begin, end] to where low <= start + t * rate <= high.
void limit(double start, double rate, double low, double high, double& begin, double& end) {
  if (rate == 0.0) {
    if (start < low || start > high) end = begin;
    return;
  }
  const double a = (low - start) / rate;
  const double b = (high - start) / rate;
  begin = std::max(begin, std::min(a, b));
  end = std::min(end, std::max(a, b));
}

// Ranges along the ray at which it passes from one column (or row) to the next.
void add_cell_borders(double start,
                      double rate,
                      double begin,
                      double end,
                      double origin,
                      double resolution,
                      std::vector<double>& ranges) {
  if (rate == 0.0) return;
  const double a = (start + begin * rate - origin) / resolution;
  const double b = (start + end * rate - origin) / resolution;
  for (double k = std::ceil(std::min(a, b)); k <= std::max(a, b); k += 1.0) {
    ranges.push_back(std::clamp((origin + k * resolution - start) / rate, begin, end));
  }
}

void require_valid(const PlanFrame& frame, const FloorBand& band) {
  if (!(frame.resolution > 0.0) || frame.columns <= 0 || frame.rows <= 0) {
    throw usage_error("plan truth: the frame has no cells");
  }
  if (!(band.z_min < band.z_max)) throw usage_error("plan truth: the band is empty");
}

}  // namespace

PlanTruth solids_in_band(const World& world, const PlanFrame& frame, const FloorBand& band) {
  require_valid(frame, band);
  const AlignedBox2d whole(frame.corner(0, 0), frame.corner(frame.columns, frame.rows));
  BandRaster raster(frame, band);
  bool any_floor = false;
  for (const FloorPiece& piece : world.floors) {
    if (!piece.on_level(band.level)) continue;
    any_floor = true;
    if (!whole.intersects(piece.area)) continue;
    for (const Primitive& solid : world.primitives) raster.add(solid, piece);
  }
  if (!any_floor) {
    throw usage_error("plan truth: level " + std::to_string(band.level) + " has no floor");
  }
  return raster.take();
}

void mark_crossed(const World& world,
                  const FloorBand& band,
                  const Vector3d& from,
                  const Vector3d& to,
                  const PlanFrame& frame,
                  std::vector<std::uint8_t>& crossed) {
  const double length = (to - from).norm();
  if (!(length > 0.0)) return;
  const Vector3d along = (to - from) / length;
  std::vector<double> ranges;
  for (const FloorPiece& piece : world.floors) {
    if (!piece.on_level(band.level)) continue;
    const Vector2d far = frame.corner(frame.columns, frame.rows);
    double begin = 0.0;
    double end = length;
    for (const int axis : {0, 1}) {
      const double low = std::max(piece.area.min()[axis], frame.lower_left[axis]);
      const double high = std::min(piece.area.max()[axis], far[axis]);
      limit(from[axis], along[axis], low, high, begin, end);
    }
    const double start = above_floor(piece, from).z();
    const double rise = along.z() - piece.slope.dot(along.head<2>());
    limit(start, rise, band.z_min, band.z_max, begin, end);
    if (end - begin < border) continue;
    ranges = {begin, end};
    for (const int axis : {0, 1}) {
      add_cell_borders(
          from[axis], along[axis], begin, end, frame.lower_left[axis], frame.resolution, ranges);
    }
    std::ranges::sort(ranges);
    for (std::size_t i = 1; i < ranges.size(); ++i) {
      if (ranges[i] - ranges[i - 1] < border) continue;
      const Vector3d middle = from + 0.5 * (ranges[i - 1] + ranges[i]) * along;
      const Vector2d cell = (middle.head<2>() - frame.lower_left) / frame.resolution;
      const int column = std::clamp(static_cast<int>(cell.x()), 0, frame.columns - 1);
      const int row = std::clamp(static_cast<int>(cell.y()), 0, frame.rows - 1);
      crossed[frame.index(column, row)] = 1;
    }
  }
}

void mark_crossed(const Simulator& simulator,
                  std::size_t scan_idx,
                  bool no_returns,
                  const FloorBand& band,
                  const PlanFrame& frame,
                  std::vector<std::uint8_t>& crossed) {
  require_valid(frame, band);
  const LabelledScan labelled = simulator.labelled_scan(scan_idx);
  const Scan& scan = labelled.scan;
  const auto ray = [&](const Eigen::Vector3f& direction, float time_offset, double range) {
    const auto stamp = scan.stamp_ns + static_cast<std::int64_t>(
                                           std::llround(1e9 * static_cast<double>(time_offset)));
    const Rigid3 map_from_lidar = simulator.map_from_lidar(stamp);
    const Vector3d end = map_from_lidar * (range * direction.cast<double>().normalized());
    mark_crossed(simulator.caster().world(), band, map_from_lidar.translation, end, frame, crossed);
  };
  for (std::size_t i = 0; i < scan.points.size(); ++i) {
    ray(scan.points[i], scan.time_offsets[i], labelled.true_ranges[i]);
  }
  if (!no_returns) return;
  for (std::size_t i = 0; i < scan.no_return_directions.size(); ++i) {
    ray(scan.no_return_directions[i], scan.no_return_time_offsets[i], simulator.sensor().max_range);
  }
}

}  // namespace kissmap::simulator
