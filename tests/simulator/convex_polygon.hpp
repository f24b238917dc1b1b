// SPDX-License-Identifier: MIT
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <vector>

namespace kissmap::simulator {

/// Corners in counter-clockwise order; empty where nothing is left.
using ConvexPolygon = std::vector<Eigen::Vector2d>;

ConvexPolygon convex_hull(std::vector<Eigen::Vector2d> points);
ConvexPolygon rectangle(const Eigen::AlignedBox2d& box);

/// The part where normal . p <= offset.
ConvexPolygon clipped(const ConvexPolygon& polygon, const Eigen::Vector2d& normal, double offset);
ConvexPolygon clipped(const ConvexPolygon& polygon, const Eigen::AlignedBox2d& box);

/// Distance [m] from a point to the filled polygon; 0 inside. Infinite for an empty one.
double distance(const ConvexPolygon& polygon, const Eigen::Vector2d& point);

}  // namespace kissmap::simulator
