// SPDX-License-Identifier: MIT
#include "occupancy/scan_rays.hpp"

namespace kissmap::occupancy {

ScanRays rays_of(const PlacedScan& scan, const Rigid3& frame_from_lidar, double no_return_range) {
  const Eigen::Matrix3f turn = frame_from_lidar.rotation.toRotationMatrix().cast<float>();
  const std::size_t without = no_return_range > 0.0 ? scan.no_return_directions.size() : 0;
  const std::size_t size = scan.points.size() + without;
  ScanRays rays;
  rays.offset = frame_from_lidar.translation;
  rays.starts.reserve(size);
  rays.ends.reserve(size);
  for (std::size_t i = 0; i < scan.points.size(); ++i) {
    rays.starts.emplace_back(turn * scan.origins[i]);
    rays.ends.emplace_back(turn * scan.points[i]);
  }
  const auto reach = static_cast<float>(no_return_range);
  for (std::size_t i = 0; i < without; ++i) {
    rays.starts.emplace_back(turn * scan.no_return_origins[i]);
    rays.ends.emplace_back(turn *
                           (scan.no_return_origins[i] + reach * scan.no_return_directions[i]));
  }
  rays.is_hit.assign(scan.points.size(), 1);
  rays.is_hit.resize(size, 0);
  return rays;
}

}  // namespace kissmap::occupancy
