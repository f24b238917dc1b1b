// SPDX-License-Identifier: MIT
#include "formats/logs/kitti_scans.hpp"

#include <cmath>
#include <numbers>
#include <string>

#include "kissmap/error.hpp"

namespace kissmap {

void require_kitti_columns(const ReadOptions& options) {
  if (options.bin_columns == 0 || options.bin_columns == 4) return;
  throw usage_error("bin_columns = " + std::to_string(options.bin_columns) +
                    ": KITTI's .bin files have 4; read others as a folder, with --format folder");
}

Eigen::Vector3f raised_by_kitti_correction(const Eigen::Vector3f& point) {
  static const double angle = 0.205 * std::numbers::pi / 180.0;
  static const double cosine = std::cos(angle);
  static const double sine = std::sin(angle);
  const Eigen::Vector3d p = point.cast<double>();
  const double horizontal = std::sqrt(p.x() * p.x() + p.y() * p.y());
  if (horizontal == 0.0) return point;
  const double scale = cosine - sine * p.z() / horizontal;
  const Eigen::Vector3d raised(scale * p.x(), scale * p.y(), cosine * p.z() + sine * horizontal);
  // Rounding must not carry a point over the limit that scans keep.
  const Eigen::Vector3f rounded = raised.cast<float>();
  return rounded.norm() <= max_plausible_range ? rounded : point;
}

double kitti_sweep_fraction(const Eigen::Vector3f& point) {
  const double azimuth = std::atan2(double{point.y()}, double{point.x()});
  return 0.5 * (1.0 - azimuth / std::numbers::pi);
}

}  // namespace kissmap
