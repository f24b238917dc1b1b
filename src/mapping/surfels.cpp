// SPDX-License-Identifier: MIT
#include "kissmap/mapping/surfels.hpp"

#include <Eigen/Eigenvalues>

namespace kissmap {
namespace {

Eigen::Vector3d least_direction(std::span<const Eigen::Vector3f> points,
                                const Eigen::Vector3d& mean) {
  Eigen::Matrix3d scatter = Eigen::Matrix3d::Zero();
  for (const Eigen::Vector3f& point : points) {
    const Eigen::Vector3d d = point.cast<double>() - mean;
    scatter += d * d.transpose();
  }
  Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver;
  solver.computeDirect(scatter);  // eigenvalues ascend
  return solver.eigenvectors().col(0);
}

}  // namespace

SurfelCloud surfels_from_grid(const VoxelHashMap& grid) {
  SurfelCloud surfels;
  surfels.means.reserve(grid.voxel_count());
  surfels.normals.reserve(grid.voxel_count());
  grid.for_each_voxel([&surfels](std::span<const Eigen::Vector3f> points) {
    if (points.size() < min_points_per_surfel) return;
    Eigen::Vector3d mean = Eigen::Vector3d::Zero();
    for (const Eigen::Vector3f& point : points) mean += point.cast<double>();
    mean /= static_cast<double>(points.size());
    Eigen::Vector3d normal = least_direction(points, mean);
    if (normal.dot(mean) > 0.0) normal = -normal;
    surfels.means.push_back(mean.cast<float>());
    surfels.normals.push_back(normal.cast<float>());
  });
  return surfels;
}

}  // namespace kissmap
