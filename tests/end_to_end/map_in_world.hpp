// SPDX-License-Identifier: MIT
#pragma once

#include <Eigen/Geometry>
#include <filesystem>

#include "kissmap/grid/grid_map.hpp"
#include "simulator/simulator.hpp"
#include "support/occupancy_plan.hpp"

namespace kissmap {

/// Lays the trajectory of a session, in its level frame, over the truth with the least squares.
Pose2 world_from_level(const std::filesystem::path& session, const simulator::Simulator& simulator);

/// A map as it lies in a rectangle of the world [m], each cell by the one its middle falls into.
GridMap map_in_world(const OccupancyPlan& plan,
                     const Pose2& world_from_plan,
                     const Eigen::AlignedBox2d& area);

}  // namespace kissmap
