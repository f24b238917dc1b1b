// SPDX-License-Identifier: MIT
#include "kissmap/grid/wall_direction.hpp"

#include <cmath>
#include <complex>

namespace kissmap {
namespace {

constexpr float most_up = 0.2F;          // of a wall's normal
constexpr double least_agreement = 0.1;  // 0: any direction alike, 1: all walls square

}  // namespace

double wall_direction(std::span<const Eigen::Vector3f> normals) {
  // Four times the angle is the same for both sides of a wall and for one square to it.
  std::complex<double> sum = 0.0;
  double count = 0.0;
  for (const Eigen::Vector3f& normal : normals) {
    if (!(std::abs(normal.z()) < most_up)) continue;
    const double angle =
        std::atan2(static_cast<double>(normal.y()), static_cast<double>(normal.x()));
    sum += std::polar(1.0, 4.0 * angle);
    count += 1.0;
  }
  if (count == 0.0 || std::abs(sum) < least_agreement * count) return 0.0;
  return std::arg(sum) / 4.0;
}

}  // namespace kissmap
