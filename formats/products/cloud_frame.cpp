// SPDX-License-Identifier: MIT
#include "formats/products/cloud_frame.hpp"

namespace kissmap {
namespace {

constexpr double single_precision_reach = 8192.0;  // m
constexpr double kilometre = 1000.0;

// + 0: no minus zero, which would be printed.
Eigen::Vector3d rounded_to(const Eigen::Vector3d& point, double step) {
  return (step * (point / step).array().round() + 0.0).matrix();
}

}  // namespace

Eigen::AlignedBox3d reach_of(const Session& session, double max_range) {
  Eigen::AlignedBox3d box(Eigen::Vector3d::Zero().eval());
  for (std::size_t i = 0; i < session.scans.size(); ++i) {
    const Eigen::Vector3d& position = session.scans[i].mapped.map_from_lidar.translation;
    const Eigen::Vector3d range = Eigen::Vector3d::Constant(max_range);
    const Eigen::AlignedBox3d reach(position - range, position + range);
    box = i == 0 ? reach : box.merged(reach);
  }
  return box;
}

Eigen::Vector3d single_precision_offset(const Eigen::AlignedBox3d& box) {
  const double reach = std::max(box.min().cwiseAbs().maxCoeff(), box.max().cwiseAbs().maxCoeff());
  if (reach <= single_precision_reach) return Eigen::Vector3d::Zero();
  return rounded_to(box.center(), kilometre);
}

Eigen::Vector3d whole_metre_centre(const Eigen::AlignedBox3d& box) {
  return rounded_to(box.center(), 1.0);
}

}  // namespace kissmap
