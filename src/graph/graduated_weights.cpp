// SPDX-License-Identifier: MIT
#include "graph/graduated_weights.hpp"

#include <cmath>
#include <limits>
#include <numbers>

namespace kissmap {
namespace {

double chi_square_below(double x, int dof) {
  const double half = 0.5 * x;
  if (dof == 6) return 1.0 - std::exp(-half) * (1.0 + half + 0.5 * half * half);
  return std::erf(std::sqrt(half)) - std::sqrt(4.0 * half / std::numbers::pi) * std::exp(-half);
}

}  // namespace

double chi_square_quantile(double probability, int dof) {
  double low = 0.0;
  double high = 200.0;
  for (int i = 0; i < 100; ++i) {
    const double middle = 0.5 * (low + high);
    (chi_square_below(middle, dof) < probability ? low : high) = middle;
  }
  return high;
}

double graduated_weight(double square, double bound, double mu) {
  if (square >= (mu + 1.0) / mu * bound) return 0.0;
  if (square <= mu / (mu + 1.0) * bound) return 1.0;
  return std::sqrt(bound / square * mu * (mu + 1.0)) - mu;
}

double first_mu(double max_square, double bound) {
  const double excess = 2.0 * max_square - bound;
  return max_square <= bound ? std::numeric_limits<double>::infinity() : bound / excess;
}

}  // namespace kissmap
