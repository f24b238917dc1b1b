// SPDX-License-Identifier: MIT
#pragma once

#include <Eigen/Core>
#include <limits>

#include "simulator/world.hpp"

namespace kissmap::simulator {

inline constexpr double no_entry = std::numeric_limits<double>::infinity();

/// Range [m] at which a ray enters a solid; `no_entry` where it misses it or starts inside. All in
/// the frame of the solid; `direction` has unit length. `slope` shears boxes, see Primitive.
double enter(Shape shape,
             const Eigen::Vector3d& origin,
             const Eigen::Vector3d& direction,
             const Eigen::Vector3d& half_extents,
             const Eigen::Vector2d& slope);

/// Outward unit normal of the face nearest to a point of the surface, in the frame of the solid.
Eigen::Vector3d surface_normal(Shape shape,
                               const Eigen::Vector3d& point,
                               const Eigen::Vector3d& half_extents,
                               const Eigen::Vector2d& slope);

}  // namespace kissmap::simulator
