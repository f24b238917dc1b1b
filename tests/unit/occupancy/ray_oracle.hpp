// SPDX-License-Identifier: MIT
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <tuple>
#include <vector>

#include "kissmap/occupancy/occupancy_map.hpp"

namespace kissmap {

inline bool operator<(const Voxel& a, const Voxel& b) {
  return std::tie(a.z, a.y, a.x) < std::tie(b.z, b.y, b.x);
}

/// A ray as a test writes it down.
struct TestRay {
  Eigen::Vector3f start, end;
  bool hit = true;
  float margin = 0.0F;
};

/// Holds the arrays a RayScan points to.
struct TestScan {
  explicit TestScan(const std::vector<TestRay>& rays,
                    const Eigen::Vector3d& offset = Eigen::Vector3d::Zero()) {
    for (const TestRay& ray : rays) {
      starts.push_back(ray.start);
      ends.push_back(ray.end);
      is_hit.push_back(ray.hit ? 1 : 0);
      margins.push_back(ray.margin);
    }
    scan = {offset, starts, ends, is_hit, margins, 0.0};
  }
  TestScan(const TestScan&) = delete;
  TestScan& operator=(const TestScan&) = delete;

  std::vector<Eigen::Vector3f> starts, ends;
  std::vector<std::uint8_t> is_hit;
  std::vector<float> margins;
  RayScan scan;
};

enum class Crossing { no, unsure, yes };

/// Whether a ray carves a voxel, by clipping it against the voxel's box in double precision; unsure
/// where it depends on less than `tolerance` voxels.
inline Crossing carves(const OccupancyGeometry& geometry,
                       const Eigen::Vector3d& offset,
                       const TestRay& ray,
                       const Voxel& voxel,
                       double tolerance = 1e-5) {
  const auto in_voxels = [&](const Eigen::Vector3f& p) -> Eigen::Vector3d {
    return (offset + p.cast<double>() - geometry.origin).cwiseQuotient(geometry.voxel_size);
  };
  const Eigen::Vector3d start = in_voxels(ray.start);
  const Eigen::Vector3d delta = in_voxels(ray.end) - start;
  const double length = delta.cwiseAbs().maxCoeff();
  double enter = 0.0;
  double leave = 1.0;
  double leave_whole = std::numeric_limits<double>::infinity();  // were the ray endless
  bool grazed = false;
  for (int a = 0; a < 3; ++a) {
    const double low = (a == 0 ? voxel.x : a == 1 ? voxel.y : voxel.z) - start[a];
    if (low > tolerance + std::max(0.0, delta[a])) return Crossing::no;
    if (low + 1.0 < std::min(0.0, delta[a]) - tolerance) return Crossing::no;
    if (std::abs(delta[a]) < tolerance) {
      // Parallel to the axis: inside, outside, or in the face.
      grazed = grazed || std::abs(low) < 2 * tolerance || std::abs(low + 1.0) < 2 * tolerance;
      continue;
    }
    const auto [near, far] = std::minmax({low / delta[a], (low + 1.0) / delta[a]});
    enter = std::max(enter, near);
    leave = std::min(leave, far);
    leave_whole = std::min(leave_whole, far);
  }
  const double slack = length > 0.0 ? tolerance / length : 0.0;
  if (leave < enter - slack) return Crossing::no;
  const double metres = (ray.end - ray.start).cast<double>().norm();
  const double share = metres > 0.0 ? std::min(1.0, ray.margin / metres) : (ray.margin > 0 ? 1 : 0);
  const bool guarded = ray.hit || ray.margin > 0.0F;
  if (guarded && leave_whole > 1.0 - share + slack) return Crossing::no;
  const bool clear = length == 0.0 ? !grazed : leave > enter + slack && !grazed;
  if (!clear || (guarded && leave_whole > 1.0 - share - slack)) return Crossing::unsure;
  return Crossing::yes;
}

/// All beliefs of a map.
inline std::map<Voxel, int> content(const OccupancyMap& map) {
  std::map<Voxel, int> all;
  map.for_each_voxel([&all](const Voxel& voxel, LogOdds value) { all[voxel] = value; });
  return all;
}

}  // namespace kissmap
