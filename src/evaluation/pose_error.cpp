// SPDX-License-Identifier: MIT
#include "kissmap/evaluation/pose_error.hpp"

#include <algorithm>
#include <cmath>

namespace kissmap {
namespace {

double median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::ranges::nth_element(values, middle);
  if (values.size() % 2 == 1) return *middle;
  return 0.5 * (*middle + *std::max_element(values.begin(), middle));
}

}  // namespace

ErrorStatistics statistics(const std::vector<double>& errors) {
  ErrorStatistics s;
  s.count = errors.size();
  if (errors.empty()) return s;
  const auto count = static_cast<double>(errors.size());
  double sum = 0.0;
  double squares = 0.0;
  for (const double error : errors) {
    sum += error;
    squares += error * error;
  }
  s.mean = sum / count;
  s.rmse = std::sqrt(squares / count);
  double deviations = 0.0;
  for (const double error : errors) deviations += (error - s.mean) * (error - s.mean);
  s.std = std::sqrt(deviations / count);
  s.median = median(errors);
  const auto [min, max] = std::ranges::minmax(errors);
  s.min = min;
  s.max = max;
  return s;
}

PoseErrors absolute_error(const std::vector<Rigid3>& reference,
                          const std::vector<Rigid3>& estimate) {
  PoseErrors errors;
  for (std::size_t i = 0; i < reference.size(); ++i) {
    const Rigid3 estimate_from_reference = estimate[i].inverse() * reference[i];
    errors.translation.push_back((estimate[i].translation - reference[i].translation).norm());
    errors.rotation.push_back(estimate_from_reference.angle());
  }
  return errors;
}

PoseErrors relative_error(const std::vector<Rigid3>& reference,
                          const std::vector<Rigid3>& estimate,
                          const std::vector<std::pair<std::size_t, std::size_t>>& pairs) {
  PoseErrors errors;
  for (const auto& [i, j] : pairs) {
    const Rigid3 true_motion = reference[i].inverse() * reference[j];
    const Rigid3 motion = estimate[i].inverse() * estimate[j];
    const Rigid3 difference = true_motion.inverse() * motion;
    errors.translation.push_back(difference.translation.norm());
    errors.rotation.push_back(difference.angle());
  }
  return errors;
}

}  // namespace kissmap
