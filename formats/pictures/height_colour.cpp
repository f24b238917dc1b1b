// SPDX-License-Identifier: MIT
#include "formats/pictures/height_colour.hpp"

#include <algorithm>
#include <array>
#include <cstddef>

namespace kissmap {

Eigen::Array3f height_colour(float share) {
  using Colour = Eigen::Array3f;
  static const std::array<Colour, 4> ramp = {Colour(0.42F, 0.47F, 0.98F),
                                             Colour(0.22F, 0.72F, 0.92F),
                                             Colour(0.36F, 0.86F, 0.52F),
                                             Colour(0.99F, 0.88F, 0.35F)};
  const float place = std::clamp(share, 0.0F, 1.0F) * static_cast<float>(ramp.size() - 1);
  const auto below = std::min(static_cast<std::size_t>(place), ramp.size() - 2);
  const float rest = place - static_cast<float>(below);
  return (1.0F - rest) * ramp[below] + rest * ramp[below + 1];
}

}  // namespace kissmap
