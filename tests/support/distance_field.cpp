// SPDX-License-Identifier: MIT
#include "support/distance_field.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace kissmap {
namespace {

constexpr double far_away = 1e12;  // cells squared

// Lower envelope of parabolas: squared distances along one line (Felzenszwalb and Huttenlocher,
// Theory of Computing 2012).
void transform_line(std::vector<double>& line) {
  const std::size_t n = line.size();
  std::vector<std::size_t> vertex(n, 0);
  std::vector<double> border(n + 1, 0.0);
  std::size_t last = 0;
  border[0] = -std::numeric_limits<double>::infinity();
  border[1] = std::numeric_limits<double>::infinity();
  const auto meet = [&line](std::size_t a, std::size_t b) {
    const auto x = static_cast<double>(a);
    const auto y = static_cast<double>(b);
    return ((line[b] + y * y) - (line[a] + x * x)) / (2.0 * (y - x));
  };
  for (std::size_t q = 1; q < n; ++q) {
    while (last > 0 && meet(vertex[last], q) <= border[last]) --last;
    const double from = meet(vertex[last], q);
    vertex[++last] = q;
    border[last] = from;
    border[last + 1] = std::numeric_limits<double>::infinity();
  }
  std::vector<double> result(n);
  std::size_t k = 0;
  for (std::size_t q = 0; q < n; ++q) {
    while (border[k + 1] < static_cast<double>(q)) ++k;
    const double away = static_cast<double>(q) - static_cast<double>(vertex[k]);
    result[q] = away * away + line[vertex[k]];
  }
  line = std::move(result);
}

}  // namespace

std::vector<double> distances_to_occupied(const OccupancyPlan& plan) {
  std::vector<double> field(plan.cells.size());
  std::ranges::transform(plan.cells, field.begin(), [](PlanCell cell) {
    return cell == PlanCell::occupied ? 0.0 : far_away;
  });
  std::vector<double> line(static_cast<std::size_t>(plan.height));
  for (int column = 0; column < plan.width; ++column) {
    for (int row = 0; row < plan.height; ++row) {
      line[static_cast<std::size_t>(row)] = field[plan.index(column, row)];
    }
    transform_line(line);
    for (int row = 0; row < plan.height; ++row) {
      field[plan.index(column, row)] = line[static_cast<std::size_t>(row)];
    }
  }
  line.resize(static_cast<std::size_t>(plan.width));
  for (int row = 0; row < plan.height; ++row) {
    const auto begin = field.begin() + static_cast<std::ptrdiff_t>(plan.index(0, row));
    line.assign(begin, begin + plan.width);
    transform_line(line);
    std::ranges::copy(line, begin);
  }
  for (double& squared : field) squared = plan.resolution * std::sqrt(squared);
  return field;
}

}  // namespace kissmap
