// SPDX-License-Identifier: MIT
#pragma once

#include "kissmap/graph/pose_graph.hpp"

namespace kissmap {

using Matrix6 = Eigen::Matrix<double, 6, 6>;

/// W with W^T W = information.
Matrix6 square_root(const Information& information);

/// Error of an edge, see optimize(), and its derivatives by a step of each end in its own frame:
/// a step d takes a pose to pose * (exp of d's rotation, d's translation).
struct EdgeResidual {
  Twist error;
  Matrix6 by_from;
  Matrix6 by_to;
};

Twist edge_error(const Rigid3& from_from_to,
                 const Rigid3& map_from_from,
                 const Rigid3& map_from_to,
                 GraphSpace space);

EdgeResidual edge_residual(const Rigid3& from_from_to,
                           const Rigid3& map_from_from,
                           const Rigid3& map_from_to,
                           GraphSpace space);

/// The pose a step away.
Rigid3 stepped(const Rigid3& pose, const Twist& step);

}  // namespace kissmap
