// SPDX-License-Identifier: MIT
#include "kissmap/odometry/registration.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "nearest_bound.hpp"

namespace kissmap {
namespace {

constexpr std::size_t points_per_chunk = 512;

Eigen::Matrix3d cross_matrix(const Eigen::Vector3d& v) {
  Eigen::Matrix3d m;
  m << 0, -v.z(), v.y(), v.z(), 0, -v.x(), -v.y(), v.x(), 0;
  return m;
}

// True if the pair found from `searched_from` is also the one a search from `query` would find.
bool still_nearest(const VoxelHashMap::Neighbor& neighbor,
                   const Eigen::Vector3f& searched_from,
                   const Eigen::Vector3f& query,
                   float max_distance) {
  const float others = others_beyond(neighbor.next_distance, (query - searched_from).norm());
  if (!neighbor.found) return others >= max_distance;
  return (query - neighbor.point).norm() < others;
}

}  // namespace

Registration::Registration(const RegistrationOptions& options, ThreadPool& pool)
    : options_(options), pool_(pool) {
}

Alignment Registration::align(std::span<const Eigen::Vector3f> source,
                              const VoxelHashMap& map,
                              const Rigid3& guess_map_from_lidar,
                              double max_pair_distance,
                              double sigma) {
  Alignment alignment{guess_map_from_lidar, Alignment::End::max_iterations, 0, 0};
  pairs_.assign(source.size(), Pair{});
  while (alignment.iterations < options_.max_iterations) {
    const Sums sums = accumulate(source, map, alignment.map_from_lidar, max_pair_distance, sigma);
    alignment.pairs = sums.pairs;
    if (sums.pairs == 0) {
      alignment.end = Alignment::End::no_pairs;
      break;
    }
    const Twist step = solve(sums);
    if (!step.allFinite()) {
      alignment.end = Alignment::End::degenerate;
      break;
    }
    alignment.map_from_lidar = exp(step) * alignment.map_from_lidar;
    ++alignment.iterations;
    if (step.norm() < options_.min_update) {
      alignment.end = Alignment::End::converged;
      break;
    }
  }
  return alignment;
}

Registration::Sums Registration::accumulate(std::span<const Eigen::Vector3f> source,
                                            const VoxelHashMap& map,
                                            const Rigid3& map_from_lidar,
                                            double max_pair_distance,
                                            double sigma) {
  const Eigen::Matrix3d rotation = map_from_lidar.rotation.toRotationMatrix();
  const auto radius = static_cast<float>(max_pair_distance);
  const std::size_t chunks = (source.size() + points_per_chunk - 1) / points_per_chunk;
  chunk_sums_.assign(chunks, Sums{});
  pool_.for_each_chunk(chunks, [&](std::size_t chunk) {
    Sums sums;
    const std::size_t end = std::min(source.size(), (chunk + 1) * points_per_chunk);
    for (std::size_t i = chunk * points_per_chunk; i < end; ++i) {
      const Eigen::Vector3d q = rotation * source[i].cast<double>() + map_from_lidar.translation;
      const Eigen::Vector3f query = q.cast<float>();
      const VoxelKey voxel = voxel_key(voxel_of(query, map.per_metre()));
      Pair& pair = pairs_[i];
      if (voxel != pair.voxel || !still_nearest(pair.neighbor, pair.searched_from, query, radius)) {
        pair = {query, map.nearest(query, radius), voxel};
      }
      if (!pair.neighbor.found) continue;
      const Eigen::Vector3d r = q - pair.neighbor.point.cast<double>();
      const double r2 = r.squaredNorm();
      // A pair kept from an earlier iteration may have drifted out of reach.
      if (r2 >= max_pair_distance * max_pair_distance) continue;
      const double w = sigma * sigma / ((sigma + r2) * (sigma + r2));
      sums.w += w;
      sums.wq += w * q;
      sums.wqq += (w * q) * q.transpose();
      sums.wr += w * r;
      sums.wqr += w * q.cross(r);
      ++sums.pairs;
    }
    chunk_sums_[chunk] = sums;
  });
  Sums total;
  for (const Sums& sums : chunk_sums_) {
    total.w += sums.w;
    total.wq += sums.wq;
    total.wqq += sums.wqq;
    total.wr += sums.wr;
    total.wqr += sums.wqr;
    total.pairs += sums.pairs;
  }
  return total;
}

Twist Registration::solve(const Sums& sums) {
  // J = [I | -[q]x]: J'WJ = [w I, -[wq]x; [wq]x, tr(wqq) I - wqq], J'Wr = [wr; wqr].
  const Eigen::Matrix3d wq = cross_matrix(sums.wq);
  Eigen::Matrix<double, 6, 6> normal;
  normal.topLeftCorner<3, 3>() = sums.w * Eigen::Matrix3d::Identity();
  normal.topRightCorner<3, 3>() = -wq;
  normal.bottomLeftCorner<3, 3>() = wq;
  normal.bottomRightCorner<3, 3>() = sums.wqq.trace() * Eigen::Matrix3d::Identity() - sums.wqq;
  Twist gradient;
  gradient << sums.wr, sums.wqr;
  return normal.ldlt().solve(-gradient);
}

}  // namespace kissmap
