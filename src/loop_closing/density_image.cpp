// SPDX-License-Identifier: MIT
#include "kissmap/loop_closing/density_image.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

namespace kissmap {
namespace {

constexpr float darkest = 0.05F;  // lower densities are set to 0

std::vector<Eigen::Vector2f> from_above(std::span<const Eigen::Vector3f> points,
                                        const Rigid3& ground_from_local_map) {
  const Eigen::Matrix<float, 2, 4> project =
      ground_from_local_map.matrix().topRows<2>().cast<float>();
  std::vector<Eigen::Vector2f> flat;
  flat.reserve(points.size());
  for (const Eigen::Vector3f& point : points) {
    flat.emplace_back(project.leftCols<3>() * point + project.col(3));
  }
  return flat;
}

std::vector<std::uint8_t> scaled(const std::vector<std::uint32_t>& counts) {
  const std::uint32_t most = *std::ranges::max_element(counts);
  // Maps always have pixels without points, so the smallest count is 0.
  const float scale = 1.0F / static_cast<float>(std::max(1U, most));
  std::vector<std::uint8_t> pixels(counts.size());
  std::ranges::transform(counts, pixels.begin(), [scale](std::uint32_t count) {
    const float density = static_cast<float>(count) * scale;
    return density < darkest ? std::uint8_t{0}
                             : static_cast<std::uint8_t>(std::lround(255.0F * density));
  });
  return pixels;
}

}  // namespace

DensityImage density_image(std::span<const Eigen::Vector3f> points,
                           const Rigid3& ground_from_local_map,
                           double pixel_size,
                           int max_side) {
  DensityImage image;
  image.pixel_size = pixel_size;
  if (points.empty()) return image;
  const std::vector<Eigen::Vector2f> flat = from_above(points, ground_from_local_map);
  Eigen::AlignedBox2f box;
  for (const Eigen::Vector2f& point : flat) box.extend(point);
  // Pixel borders lie on multiples of the pixel size.
  const auto per_metre = static_cast<float>(1.0 / pixel_size);
  const Eigen::Vector2f first = (box.min() * per_metre).array().floor();
  const Eigen::Vector2f last = (box.max() * per_metre).array().floor();
  const Eigen::Vector2f sides = last - first;
  if (!(sides.maxCoeff() < static_cast<float>(max_side))) return image;
  image.width = static_cast<int>(sides.x()) + 1;
  image.height = static_cast<int>(sides.y()) + 1;
  image.corner = first.cast<double>() * pixel_size;
  std::vector<std::uint32_t> counts(static_cast<std::size_t>(image.width) *
                                    static_cast<std::size_t>(image.height));
  for (const Eigen::Vector2f& point : flat) {
    const Eigen::Vector2f pixel = (point * per_metre).array().floor().matrix() - first;
    ++counts[static_cast<std::size_t>(pixel.y()) * static_cast<std::size_t>(image.width) +
             static_cast<std::size_t>(pixel.x())];
  }
  image.pixels = scaled(counts);
  return image;
}

}  // namespace kissmap
