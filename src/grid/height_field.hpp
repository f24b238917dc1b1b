// SPDX-License-Identifier: MIT
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

namespace kissmap {

/// Heights [m] of cells, row by row; NaN where not known.
struct HeightField {
  std::int32_t first_x = 0;  ///< cell of the lower corner, counted from the frame's origin
  std::int32_t first_y = 0;
  int width = 0;
  int height = 0;
  double cell_size = 1.0;  ///< m
  std::vector<float> z;

  std::size_t index(std::int32_t x, std::int32_t y) const {
    return static_cast<std::size_t>(y - first_y) * static_cast<std::size_t>(width) +
           static_cast<std::size_t>(x - first_x);
  }
  Eigen::Vector2d corner() const { return Eigen::Vector2d(first_x, first_y) * cell_size; }
  std::size_t known() const;
};

/// Replaces each known height by the median of the known ones within 0.75 m.
void smooth(HeightField& field);

/// Gives the unknown cells the heights of the known ones around them, over ever larger squares
/// (push-pull: Gortler et al., SIGGRAPH 1996). At least one cell is known.
void fill(HeightField& field);

}  // namespace kissmap
