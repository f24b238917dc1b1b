// SPDX-License-Identifier: MIT
#pragma once

#include <gmock/gmock.h>

#include <ostream>

#include "kissmap/geometry/rigid3.hpp"

namespace kissmap {

inline void PrintTo(const Rigid3& transform, std::ostream* os) {
  *os << "t = " << transform.translation.transpose()
      << ", q(xyzw) = " << transform.rotation.coeffs().transpose();
}

/// Same pose within metres and radians, absolute.
MATCHER_P3(PoseNear, expected, max_metres, max_radians, "") {
  const Rigid3 difference = expected.inverse() * arg;
  *result_listener << "which is " << difference.translation.norm() << " m and "
                   << difference.angle() << " rad away";
  return difference.translation.norm() <= max_metres && difference.angle() <= max_radians;
}

}  // namespace kissmap
