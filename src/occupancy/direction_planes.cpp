// SPDX-License-Identifier: MIT
#include "occupancy/direction_planes.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <numbers>

namespace kissmap::occupancy {
namespace {

// Columns turn full circle, rows half of it; both of 0.7 degrees on the finest level.
constexpr std::int32_t finest_columns = 512;
constexpr std::int32_t finest_rows = 256;
constexpr double finest_cell = 2.0 * std::numbers::pi / finest_columns;

constexpr double min_points = 6.0;

// Of the width of 3 cells where the points are: residual of a plane, and its extent to the side.
// A step in depth in the middle leaves 0.14.
constexpr double max_residual = 0.07;
constexpr double min_extent = 0.1;

std::int32_t columns(int level) {
  return finest_columns >> level;
}
std::int32_t rows(int level) {
  return finest_rows >> level;
}
std::size_t cell_index(int level, std::int32_t column, std::int32_t row) {
  const std::int32_t index = row * columns(level) + (column & (columns(level) - 1));
  return static_cast<std::size_t>(index);
}

}  // namespace

struct DirectionPlanes::Sums {
  double count = 0.0;
  double range = 0.0;
  Eigen::Vector3d first = Eigen::Vector3d::Zero();
  Eigen::Vector3d squares = Eigen::Vector3d::Zero();   // xx, yy, zz
  Eigen::Vector3d products = Eigen::Vector3d::Zero();  // xy, xz, yz

  void add(const Eigen::Vector3d& p, double distance) {
    count += 1.0;
    range += distance;
    first += p;
    squares += p.cwiseAbs2();
    products += Eigen::Vector3d(p.x() * p.y(), p.x() * p.z(), p.y() * p.z());
  }
  void add(const Sums& other) {
    count += other.count;
    range += other.range;
    first += other.first;
    squares += other.squares;
    products += other.products;
  }
  Eigen::Matrix3d covariance() const {
    Eigen::Matrix3d c;
    c << squares.x(), products.x(), products.y(),  //
        products.x(), squares.y(), products.z(),   //
        products.y(), products.z(), squares.z();
    return c / count - (first / count) * (first / count).transpose();
  }
};

DirectionCell direction_cell(const Eigen::Vector3f& direction) {
  const float azimuth = std::atan2(direction.y(), direction.x());
  const float elevation = std::atan2(direction.z(), std::hypot(direction.x(), direction.y()));
  constexpr auto pi = std::numbers::pi_v<float>;
  constexpr auto per_radian = static_cast<float>(1.0 / finest_cell);
  return {
      static_cast<std::int32_t>((azimuth + pi) * per_radian) & (finest_columns - 1),
      std::clamp(static_cast<std::int32_t>((elevation + pi / 2) * per_radian), 0, finest_rows - 1)};
}

DirectionPlanes::DirectionPlanes(std::span<const Eigen::Vector3f> points,
                                 std::span<const DirectionCell> cells,
                                 std::span<const float> ranges,
                                 ThreadPool& pool) {
  Grid sums(static_cast<std::size_t>(finest_columns * finest_rows));
  for (std::size_t i = 0; i < points.size(); ++i) {
    sums[cell_index(0, cells[i].column, cells[i].row)].add(points[i].cast<double>(), ranges[i]);
  }
  for (int level = 0; level < levels; ++level) {
    if (level > 0) sums = coarser(sums, level);
    auto& planes = planes_[static_cast<std::size_t>(level)];
    planes.resize(sums.size());
    pool.for_each_chunk(static_cast<std::size_t>(rows(level)), [&](std::size_t chunk) {
      const auto row = static_cast<std::int32_t>(chunk);
      for (std::int32_t column = 0; column < columns(level); ++column) {
        planes[cell_index(level, column, row)] = fit(sums, level, column, row);
      }
    });
  }
}

DirectionPlanes::Grid DirectionPlanes::coarser(const Grid& fine, int coarse_level) {
  Grid coarse(fine.size() / 4);
  for (std::int32_t row = 0; row < rows(coarse_level - 1); ++row) {
    for (std::int32_t column = 0; column < columns(coarse_level - 1); ++column) {
      const Sums& from = fine[cell_index(coarse_level - 1, column, row)];
      if (from.count > 0.0) coarse[cell_index(coarse_level, column / 2, row / 2)].add(from);
    }
  }
  return coarse;
}

DirectionPlane DirectionPlanes::fit(const Grid& sums,
                                    int level,
                                    std::int32_t column,
                                    std::int32_t row) {
  if (sums[cell_index(level, column, row)].count == 0.0) return {};
  // Columns may be farther apart than cells: then one of them is no plane, and two are.
  for (const std::int32_t reach : {1, 2}) {
    Sums window;
    for (std::int32_t r = std::max(0, row - 1); r <= std::min(rows(level) - 1, row + 1); ++r) {
      for (std::int32_t c = column - reach; c <= column + reach; ++c) {
        window.add(sums[cell_index(level, c, r)]);
      }
    }
    if (window.count < min_points) continue;
    Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver;
    solver.computeDirect(window.covariance());  // eigenvalues ascend
    const double width = 3.0 * finest_cell * (1 << level) * window.range / window.count;
    const double residual = std::sqrt(std::max(0.0, solver.eigenvalues()[0]));
    const double extent = std::sqrt(std::max(0.0, solver.eigenvalues()[1]));
    if (!(residual < max_residual * width)) return {};
    if (!(extent > min_extent * width)) continue;
    const Eigen::Vector3d normal = solver.eigenvectors().col(0);
    return {normal.cast<float>(), static_cast<float>(normal.dot(window.first) / window.count)};
  }
  return {};
}

DirectionPlanes::Neighbors DirectionPlanes::around(int level, const DirectionCell& cell) const {
  const auto& planes = planes_[static_cast<std::size_t>(level)];
  const std::int32_t row = cell.row >> level;
  const std::int32_t column = cell.column >> level;
  Neighbors found;
  std::size_t n = 0;
  for (std::int32_t r = row - 1; r <= row + 1; ++r) {
    const std::int32_t inside = std::clamp(r, 0, rows(level) - 1);
    for (std::int32_t c = column - 1; c <= column + 1; ++c) {
      found[n++] = &planes[cell_index(level, c, inside)];
    }
  }
  return found;
}

}  // namespace kissmap::occupancy
