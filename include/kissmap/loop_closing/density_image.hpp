// SPDX-License-Identifier: MIT
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <vector>

#include "kissmap/geometry/rigid3.hpp"

namespace kissmap {

/// A local map from above: how many of its points stand over each pixel (METHOD section 3.2).
struct DensityImage {
  int width = 0;                     ///< pixels along x
  int height = 0;                    ///< pixels along y
  double pixel_size = 0.0;           ///< m
  Eigen::Vector2d corner{0.0, 0.0};  ///< m, outer corner of pixel (0, 0), ground frame
  std::vector<std::uint8_t> pixels;  ///< row by row, rows along x; 0 empty .. 255 densest

  bool empty() const { return pixels.empty(); }
};

/// Counts scaled to 0..1 between the smallest and the largest of occupied pixels, values under 0.05
/// set to 0. Empty where there is no point or a side would exceed `max_side` pixels.
/// `points` in the local_map frame [m]; the image is in the ground frame. Pure.
DensityImage density_image(std::span<const Eigen::Vector3f> points,
                           const Rigid3& ground_from_local_map,
                           double pixel_size,
                           int max_side);

}  // namespace kissmap
