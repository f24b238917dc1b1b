// SPDX-License-Identifier: MIT
#include "simulator/convex_polygon.hpp"

#include <algorithm>
#include <limits>
#include <utility>

namespace kissmap::simulator {
namespace {

using Eigen::Vector2d;

double cross(const Vector2d& a, const Vector2d& b) {
  return a.x() * b.y() - a.y() * b.x();
}

}  // namespace

// Monotone chain (Andrew 1979).
ConvexPolygon convex_hull(std::vector<Vector2d> points) {
  std::ranges::sort(points, {}, [](const Vector2d& p) { return std::pair(p.x(), p.y()); });
  points.erase(std::unique(points.begin(), points.end()), points.end());
  if (points.size() < 3) return points;
  ConvexPolygon hull;
  const auto add = [&hull](const Vector2d& p, std::size_t keep) {
    while (hull.size() >= keep + 2 &&
           cross(hull.back() - hull[hull.size() - 2], p - hull.back()) <= 0.0) {
      hull.pop_back();
    }
    hull.push_back(p);
  };
  for (const Vector2d& p : points) add(p, 0);
  const std::size_t lower = hull.size() - 1;
  for (std::size_t i = points.size() - 1; i-- > 0;) add(points[i], lower);
  hull.pop_back();
  return hull;
}

ConvexPolygon rectangle(const Eigen::AlignedBox2d& box) {
  return {box.min(), {box.max().x(), box.min().y()}, box.max(), {box.min().x(), box.max().y()}};
}

// Sutherland and Hodgman, 1974.
ConvexPolygon clipped(const ConvexPolygon& polygon, const Vector2d& normal, double offset) {
  ConvexPolygon rest;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Vector2d& a = polygon[i];
    const Vector2d& b = polygon[(i + 1) % polygon.size()];
    const double beyond_a = normal.dot(a) - offset;
    const double beyond_b = normal.dot(b) - offset;
    if (beyond_a <= 0.0) rest.push_back(a);
    if (beyond_a * beyond_b < 0.0) rest.push_back(a + beyond_a / (beyond_a - beyond_b) * (b - a));
  }
  return rest;
}

ConvexPolygon clipped(const ConvexPolygon& polygon, const Eigen::AlignedBox2d& box) {
  ConvexPolygon rest = polygon;
  for (const int axis : {0, 1}) {
    rest = clipped(rest, Vector2d::Unit(axis), box.max()[axis]);
    rest = clipped(rest, -Vector2d::Unit(axis), -box.min()[axis]);
  }
  return rest;
}

double distance(const ConvexPolygon& polygon, const Vector2d& point) {
  double nearest = std::numeric_limits<double>::infinity();
  bool inside = polygon.size() > 2;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Vector2d& a = polygon[i];
    const Vector2d along = polygon[(i + 1) % polygon.size()] - a;
    const double length = along.squaredNorm();
    const double part = length > 0.0 ? std::clamp((point - a).dot(along) / length, 0.0, 1.0) : 0.0;
    nearest = std::min(nearest, (point - a - part * along).norm());
    inside = inside && cross(along, point - a) >= 0.0;
  }
  return inside ? 0.0 : nearest;
}

}  // namespace kissmap::simulator
