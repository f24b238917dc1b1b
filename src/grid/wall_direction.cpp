// SPDX-License-Identifier: MIT
#include "kissmap/grid/wall_direction.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <numbers>
#include <vector>

namespace kissmap {
namespace {

constexpr float most_up = 0.2F;          // of a wall's normal
constexpr double least_agreement = 0.1;  // 0: any direction alike, 1: all walls square
constexpr double quarter = 0.5 * std::numbers::pi;
constexpr double degree = std::numbers::pi / 180.0;
constexpr std::size_t bins = 90;  // of a degree
constexpr double near = 6.0 * degree;
constexpr int rounds = 5;

/// The same for both sides of a wall and for one square to it: in (-pi/4, pi/4].
double within_quarter(double angle) {
  const double rest = std::remainder(angle, quarter);
  return rest > -0.25 * std::numbers::pi ? rest : rest + quarter;
}

/// The middle of the five degrees with the most angles.
double crowded(const std::vector<double>& angles) {
  std::array<std::size_t, bins> counts{};
  for (const double angle : angles) {
    const auto bin = static_cast<std::size_t>((angle + 0.25 * std::numbers::pi) / degree);
    ++counts[std::min(bin, bins - 1)];
  }
  std::size_t best = 0;
  std::size_t most = 0;
  for (std::size_t i = 0; i < bins; ++i) {
    std::size_t around = 0;
    for (std::size_t k = bins - 2; k <= bins + 2; ++k) around += counts[(i + k) % bins];
    if (around <= most) continue;
    most = around;
    best = i;
  }
  return (static_cast<double>(best) + 0.5) * degree - 0.25 * std::numbers::pi;
}

double mean_near(const std::vector<double>& angles, double direction) {
  double sum = 0.0;
  double count = 0.0;
  for (const double angle : angles) {
    const double off = within_quarter(angle - direction);
    if (std::abs(off) > near) continue;
    sum += off;
    count += 1.0;
  }
  return count == 0.0 ? direction : within_quarter(direction + sum / count);
}

}  // namespace

double wall_direction(std::span<const Eigen::Vector3f> normals) {
  std::complex<double> sum = 0.0;
  std::vector<double> angles;
  for (const Eigen::Vector3f& normal : normals) {
    if (!(std::abs(normal.z()) < most_up)) continue;
    const double angle =
        std::atan2(static_cast<double>(normal.y()), static_cast<double>(normal.x()));
    sum += std::polar(1.0, 4.0 * angle);
    angles.push_back(within_quarter(angle));
  }
  if (angles.empty() || std::abs(sum) < least_agreement * static_cast<double>(angles.size())) {
    return 0.0;
  }
  // Not the mean of all: that follows every bookcase that stands askew.
  double direction = crowded(angles);
  for (int round = 0; round < rounds; ++round) direction = mean_near(angles, direction);
  return direction;
}

}  // namespace kissmap
