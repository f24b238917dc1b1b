// SPDX-License-Identifier: MIT
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <vector>

#include "kissmap/grid/floor_samples.hpp"

namespace kissmap {

/// Height of the floor over a rectangle of the level frame, continuous and defined everywhere:
/// seen where it was seen, filled in between, and carried on level beyond the border.
class FloorMap {
 public:
  /// Heights at the middles of cells, row by row from the lowest y; `corner` is the lower corner of
  /// the first cell [m]. width * height heights, or none: then the floor is z = 0 everywhere.
  FloorMap() = default;
  /// `seen` has a byte a cell, or none: then the floor is known everywhere.
  FloorMap(Eigen::Vector2d corner,
           double cell_size,
           int width,
           int height,
           std::vector<float> z,
           std::vector<std::uint8_t> seen = {});

  /// m, bilinear between the middles of cells.
  double height(double x, double y) const;
  /// Whether the floor was seen at a place or beside it, not only filled in or carried on.
  bool is_seen(double x, double y) const;
  /// Lowest and highest of all heights.
  double lowest() const { return lowest_; }
  double highest() const { return highest_; }
  double cell_size() const { return cell_size_; }

 private:
  Eigen::Vector2d corner_ = Eigen::Vector2d::Zero();
  double cell_size_ = 1.0;
  double cells_per_metre_ = 1.0;
  int width_ = 0;
  int height_ = 0;
  std::vector<float> z_;
  std::vector<std::uint8_t> is_seen_;
  double lowest_ = 0.0;
  double highest_ = 0.0;
};

/// Where the sensor was, in the level frame [m].
using SensorPath = std::vector<Eigen::Vector3d>;

/// How high above the floor the sensor is carried [m]: the height at which most of the path finds a
/// surface under it. Zero if there is none.
double sensor_height(const SensorPath& path,
                     std::span<const FloorSample> samples,
                     double cell_size);

/// The floor that is reached on foot or wheels from under `path` (part of the whole one): surfaces
/// that go on from there without a step, the nearest ones first, so that below a gallery its
/// floor counts only for a path that is up there. Desks, kerbstones and bonnets are not reached;
/// narrow ones that are (a mat, a doorstep) are smoothed away. Where nothing of it is seen, it is
/// filled in from around; within 2 m of where it was it counts as seen.
FloorMap floor_under(const SensorPath& path,
                     std::span<const FloorSample> samples,
                     double cell_size,
                     double sensor_height);

}  // namespace kissmap
