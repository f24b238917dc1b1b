// SPDX-License-Identifier: MIT
#pragma once

#include <optional>
#include <vector>

#include "kissmap/geometry/rigid3.hpp"

namespace kissmap {

/// How the map of an estimate is laid over that of the reference before poses are compared.
enum class MapAlignment {
  se3,    ///< rotation and translation, least squares over positions (Umeyama 1991 without scale)
  yaw,    ///< the same with a rotation about z alone: errors of roll and pitch stay
  first,  ///< the first poses coincide
  none,   ///< as they are
};

/// reference_from_map such that reference_from_map * estimate[i] is near reference[i]. The lists
/// are equally long. Nothing where the positions leave the rotation open: fewer than two of them
/// apart, and for se3 also when all lie on one line.
std::optional<Rigid3> align(const std::vector<Rigid3>& reference,
                            const std::vector<Rigid3>& estimate,
                            MapAlignment alignment);

/// `a_from_b` times each of `b_from_c`.
std::vector<Rigid3> transformed(const Rigid3& a_from_b, const std::vector<Rigid3>& b_from_c);

}  // namespace kissmap
