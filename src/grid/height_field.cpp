// SPDX-License-Identifier: MIT
#include "grid/height_field.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace kissmap {
namespace {

constexpr double median_reach = 0.75;  // m
constexpr float unknown = std::numeric_limits<float>::quiet_NaN();

/// A field of half the resolution: means of the known cells of 2 x 2.
HeightField pulled(const HeightField& fine) {
  HeightField coarse;
  coarse.width = (fine.width + 1) / 2;
  coarse.height = (fine.height + 1) / 2;
  coarse.z.assign(static_cast<std::size_t>(coarse.width) * static_cast<std::size_t>(coarse.height),
                  unknown);
  for (int y = 0; y < coarse.height; ++y) {
    for (int x = 0; x < coarse.width; ++x) {
      float sum = 0.0F;
      float count = 0.0F;
      for (int v = 2 * y; v < std::min(2 * y + 2, fine.height); ++v) {
        for (int u = 2 * x; u < std::min(2 * x + 2, fine.width); ++u) {
          const float z =
              fine.z[static_cast<std::size_t>(v) * static_cast<std::size_t>(fine.width) +
                     static_cast<std::size_t>(u)];
          if (std::isnan(z)) continue;
          sum += z;
          count += 1.0F;
        }
      }
      if (count > 0.0F) coarse.z[coarse.index(x, y)] = sum / count;
    }
  }
  return coarse;
}

/// Height of a coarse field without gaps at the middle of a cell of the finer one.
float between(const HeightField& coarse, int x, int y) {
  const auto at = [&coarse](int u, int v) {
    return coarse
        .z[coarse.index(std::clamp(u, 0, coarse.width - 1), std::clamp(v, 0, coarse.height - 1))];
  };
  // A fine cell's middle is a quarter of a coarse cell off the coarse one's.
  const int u = x / 2;
  const int v = y / 2;
  const int aside_u = x % 2 == 0 ? u - 1 : u + 1;
  const int aside_v = y % 2 == 0 ? v - 1 : v + 1;
  return 0.5625F * at(u, v) + 0.1875F * at(aside_u, v) + 0.1875F * at(u, aside_v) +
         0.0625F * at(aside_u, aside_v);
}

}  // namespace

std::size_t HeightField::known() const {
  return static_cast<std::size_t>(
      std::ranges::count_if(z, [](float cell) { return !std::isnan(cell); }));
}

void smooth(HeightField& field) {
  const int reach = static_cast<int>(median_reach / field.cell_size);
  std::vector<float> around;
  std::vector<float> smoothed = field.z;
  for (int y = 0; y < field.height; ++y) {
    for (int x = 0; x < field.width; ++x) {
      const std::size_t i = static_cast<std::size_t>(y) * static_cast<std::size_t>(field.width) +
                            static_cast<std::size_t>(x);
      if (std::isnan(field.z[i])) continue;
      around.clear();
      for (int v = std::max(0, y - reach); v <= std::min(field.height - 1, y + reach); ++v) {
        for (int u = std::max(0, x - reach); u <= std::min(field.width - 1, x + reach); ++u) {
          const float z =
              field.z[static_cast<std::size_t>(v) * static_cast<std::size_t>(field.width) +
                      static_cast<std::size_t>(u)];
          if (!std::isnan(z)) around.push_back(z);
        }
      }
      const auto middle = around.begin() + static_cast<std::ptrdiff_t>(around.size() / 2);
      std::ranges::nth_element(around, middle);
      smoothed[i] = *middle;
    }
  }
  field.z = std::move(smoothed);
}

void fill(HeightField& field) {
  if (field.known() == field.z.size()) return;
  HeightField coarse = pulled(field);
  fill(coarse);
  for (int y = 0; y < field.height; ++y) {
    for (int x = 0; x < field.width; ++x) {
      float& z = field.z[static_cast<std::size_t>(y) * static_cast<std::size_t>(field.width) +
                         static_cast<std::size_t>(x)];
      if (std::isnan(z)) z = between(coarse, x, y);
    }
  }
}

}  // namespace kissmap
