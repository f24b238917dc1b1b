// SPDX-License-Identifier: MIT
#include "kissmap/loop_closing/ground_alignment.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <unordered_map>
#include <vector>

#include "kissmap/cloud/voxel.hpp"

namespace kissmap {
namespace {

constexpr float column_size = 5.0F;  // m
constexpr double first_reach = 5.0;  // m, samples farther from the plane are no ground
constexpr double last_reach = 0.5;   // m
constexpr int max_iterations = 20;
constexpr double min_update = 1e-4;  // m and slope
constexpr std::size_t min_samples = 3;

std::vector<Eigen::Vector3d> lowest_points(std::span<const Eigen::Vector3f> points) {
  std::unordered_map<VoxelKey, std::size_t> place;
  std::vector<Eigen::Vector3d> lowest;
  for (const Eigen::Vector3f& point : points) {
    Voxel column = voxel_of(point, 1.0F / column_size);
    column.z = 0;
    const auto [it, added] = place.try_emplace(voxel_key(column), lowest.size());
    if (added) {
      lowest.push_back(point.cast<double>());
    } else if (point.z() < lowest[it->second].z()) {
      lowest[it->second] = point.cast<double>();
    }
  }
  return lowest;
}

/// z = plane(0) + plane(1) x + plane(2) y
using Plane = Eigen::Vector3d;

std::optional<Plane> fit(const std::vector<Eigen::Vector3d>& samples) {
  Plane plane = Plane::Zero();
  double reach = first_reach;
  // The start is the height most samples agree on, as the sensor's own height is not known.
  std::vector<double> heights;
  heights.reserve(samples.size());
  for (const Eigen::Vector3d& sample : samples) heights.push_back(sample.z());
  const auto middle = heights.begin() + static_cast<std::ptrdiff_t>(heights.size() / 2);
  std::ranges::nth_element(heights, middle);
  plane(0) = *middle;
  for (int i = 0; i < max_iterations; ++i) {
    Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
    Eigen::Vector3d right = Eigen::Vector3d::Zero();
    for (const Eigen::Vector3d& sample : samples) {
      const Eigen::Vector3d row(1.0, sample.x(), sample.y());
      const double off = (sample.z() - plane.dot(row)) / reach;
      if (std::abs(off) >= 1.0) continue;
      const double weight = (1.0 - off * off) * (1.0 - off * off);  // Tukey's biweight
      normal += weight * row * row.transpose();
      right += weight * sample.z() * row;
    }
    // A weak pull to the level plane decides what the samples leave open.
    normal(1, 1) += 1.0;
    normal(2, 2) += 1.0;
    const Eigen::LDLT<Eigen::Matrix3d> solver(normal);
    if (normal(0, 0) < 1e-6) return std::nullopt;
    const Plane next = solver.solve(right);
    const double update = (next - plane).norm();
    plane = next;
    reach = std::max(last_reach, 0.7 * reach);
    if (update < min_update && reach == last_reach) break;
  }
  return plane;
}

}  // namespace

std::optional<Rigid3> ground_from_local_map(std::span<const Eigen::Vector3f> points) {
  const std::vector<Eigen::Vector3d> samples = lowest_points(points);
  if (samples.size() < min_samples) return std::nullopt;
  const std::optional<Plane> plane = fit(samples);
  if (!plane || !plane->allFinite()) return std::nullopt;
  const Eigen::Vector3d up = Eigen::Vector3d(-(*plane)(1), -(*plane)(2), 1.0).normalized();
  if (up.z() < std::numbers::sqrt2 / 2.0) return std::nullopt;
  Rigid3 ground_from_map;
  ground_from_map.rotation = Eigen::Quaterniond::FromTwoVectors(up, Eigen::Vector3d::UnitZ());
  const Eigen::Vector3d on_ground(0.0, 0.0, (*plane)(0));
  ground_from_map.translation = {0.0, 0.0, -(ground_from_map.rotation * on_ground).z()};
  return ground_from_map;
}

}  // namespace kissmap
