// SPDX-License-Identifier: MIT
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <span>

#include "kissmap/geometry/rigid3.hpp"

namespace kissmap {

/// A position in the query and the one it was matched to, in m.
struct PlanarPair {
  Eigen::Vector2f query;
  Eigen::Vector2f reference;
};

/// Rigid motion in the plane; always a proper rotation.
struct Rigid2 {
  double angle = 0.0;                                     ///< rad
  Eigen::Vector2d translation = Eigen::Vector2d::Zero();  ///< m

  Eigen::Vector2d operator*(const Eigen::Vector2d& point) const;
  Rigid3 in_space() const;  ///< about and along the axes of the ground
};

struct PlanarAlignment {
  Rigid2 reference_from_query;
  int inliers = 0;
};

/// Least-squares motion between pairs, in closed form over the angle: a reflection cannot come out.
/// Needs a pair; of one pair, or of coincident points, the angle is 0.
Rigid2 fit_planar(std::span<const PlanarPair> pairs);

/// RANSAC over two pairs (METHOD section 3.5): success 0.999 at an inlier ratio of 0.1, drawn from
/// `seed`, so that the same pairs always give the same answer. The model with the most inliers is
/// fitted again to them. Empty below two pairs.
/// Pairs whose length differs by more than 2 `inlier_distance` [m] are not tried: a rigid motion
/// keeps lengths.
std::optional<PlanarAlignment> align_planar(std::span<const PlanarPair> pairs,
                                            double inlier_distance,
                                            std::uint64_t seed);

}  // namespace kissmap
