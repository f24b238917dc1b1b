// SPDX-License-Identifier: MIT
#pragma once

#include <vector>

#include "kissmap/graph/pose_graph.hpp"

namespace kissmap {

/// Path [m] along which odometry has drifted between two keyposes: the shortest way through the
/// graph, an odometry edge being as long as its path and a closure one metre.
/// `path_lengths` by node: to the next one.
double drift_length(const PoseGraph& graph,
                    const std::vector<double>& path_lengths,
                    std::uint32_t from,
                    std::uint32_t to);

/// How far odometry that holds can be off after a path of `length` [m].
double max_drift_translation(double length);  ///< m
double max_drift_rotation(double length);     ///< rad

/// Whether odometry that holds can be off by this motion after such a path.
bool within_drift(const Rigid3& off, double length);

/// Whether this motion is so small after such a path that odometry alone makes it credible: a
/// closure that says so moves the map by a metre at most.
bool is_expected(const Rigid3& off, double length);

}  // namespace kissmap
