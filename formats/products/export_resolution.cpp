// SPDX-License-Identifier: MIT
#include "formats/products/export_resolution.hpp"

namespace kissmap {

void MeanRange::add(const PlacedScan& scan) {
  for (const Eigen::Vector3f& point : scan.points) sum_ += static_cast<double>(point.norm());
  points_ += scan.points.size();
}

double MeanRange::value() const {
  return points_ == 0 ? 0.0 : sum_ / static_cast<double>(points_);
}

double resolution_for(double mean_range) {
  if (mean_range < 8.0) return 0.05;
  return mean_range < 20.0 ? 0.1 : 0.2;
}

}  // namespace kissmap
