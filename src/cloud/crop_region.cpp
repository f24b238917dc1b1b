// SPDX-License-Identifier: MIT
#include "kissmap/cloud/crop_region.hpp"

#include "kissmap/error.hpp"

namespace kissmap {
namespace {

// Even-odd rule: a ray towards +x crosses the outline an odd number of times. Each edge owns its
// lower end only, so that a corner on the ray counts once.
bool is_inside(const std::vector<Eigen::Vector2d>& polygon, double x, double y) {
  bool inside = false;
  Eigen::Vector2d a = polygon.back();
  for (const Eigen::Vector2d& b : polygon) {
    if ((a.y() > y) != (b.y() > y)) {
      const double crossing = a.x() + (y - a.y()) / (b.y() - a.y()) * (b.x() - a.x());
      if (x < crossing) inside = !inside;
    }
    a = b;
  }
  return inside;
}

}  // namespace

bool CropRegion::contains(const Eigen::Vector3d& point) const {
  const bool in_box = point.x() >= low.x() && point.x() <= high.x() && point.y() >= low.y() &&
                      point.y() <= high.y() && point.z() >= z_min && point.z() <= z_max;
  return in_box && (polygon.empty() || is_inside(polygon, point.x(), point.y()));
}

void require_valid(const CropRegion& region) {
  if (!(region.low.x() < region.high.x()) || !(region.low.y() < region.high.y())) {
    throw usage_error("--crop: is xmin,ymin,xmax,ymax with xmin < xmax and ymin < ymax");
  }
  if (!(region.z_min < region.z_max)) throw usage_error("--z-min: has to be below --z-max");
  if (!region.polygon.empty() && region.polygon.size() < 3) {
    throw usage_error("--crop-polygon: a polygon has three corners or more");
  }
}

}  // namespace kissmap
