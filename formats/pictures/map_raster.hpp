// SPDX-License-Identifier: MIT
#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <vector>

#include "kissmap/mapping/local_map.hpp"

namespace kissmap {

/// What of a session is drawn and how large.
struct MapView {
  Eigen::Vector2d corner = Eigen::Vector2d::Zero();  ///< map frame, lower left of the picture [m]
  double pixel_size = 1.0;                           ///< m
  int width = 1;                                     ///< pixels
  int height = 1;
  double low = 0.0;  ///< heights of the ends of the colour ramp [m]
  double high = 1.0;

  /// Pixels, y down, from metres in the map frame.
  Eigen::Vector2f pixel_from_map(const Eigen::Vector2d& point) const {
    const Eigen::Vector2d p = (point - corner) / pixel_size;
    return Eigen::Vector2d(p.x(), height - 1 - p.y()).cast<float>();
  }
};

/// The trajectory and 99 % of the surfels near it, so that a few far returns do not shrink the map.
MapView choose_view(const std::filesystem::path& session,
                    const std::vector<LocalMap>& local_maps,
                    const std::vector<Eigen::Vector3d>& trajectory,
                    int max_pixels);

/// How much surface each pixel sees, and how high it is. Row 0 on top.
struct MapRaster {
  std::vector<float> density;
  std::vector<float> height;  ///< m, mean; 0 where the density is 0
};
MapRaster draw_surfels(const std::filesystem::path& session,
                       const std::vector<LocalMap>& local_maps,
                       const MapView& view);

}  // namespace kissmap
