// SPDX-License-Identifier: MIT
#include "kissmap/odometry/adaptive_threshold.hpp"

#include <cmath>

namespace kissmap {

AdaptiveThreshold::AdaptiveThreshold(double initial, double min_motion, double max_range)
    : min_motion_(min_motion), max_range_(max_range), sum_of_squares_(initial * initial) {
}

double AdaptiveThreshold::sigma() const {
  return std::sqrt(sum_of_squares_ / samples_);
}

void AdaptiveThreshold::observe(const Rigid3& predicted_from_estimated) {
  const double error = predicted_from_estimated.translation.norm() +
                       2.0 * max_range_ * std::sin(0.5 * predicted_from_estimated.angle());
  if (error <= min_motion_) return;
  sum_of_squares_ += error * error;
  samples_ += 1.0;
}

}  // namespace kissmap
