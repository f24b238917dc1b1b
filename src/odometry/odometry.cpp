// SPDX-License-Identifier: MIT
#include "kissmap/odometry/odometry.hpp"

#include "options.hpp"

namespace kissmap {
namespace {

void move_points(const Rigid3& frame_from_lidar, std::vector<Eigen::Vector3f>& points) {
  const Eigen::Matrix3d rotation = frame_from_lidar.rotation.toRotationMatrix();
  for (Eigen::Vector3f& point : points) {
    point = (rotation * point.cast<double>() + frame_from_lidar.translation).cast<float>();
  }
}

double mean_range(std::span<const Eigen::Vector3f> points_in_lidar) {
  double sum = 0.0;
  for (const Eigen::Vector3f& point : points_in_lidar) sum += static_cast<double>(point.norm());
  return sum / static_cast<double>(points_in_lidar.size());
}

}  // namespace

void require_valid(const OdometryOptions& options) {
  require_between("max_range", options.max_range, 1.0, max_plausible_range);
  require_between("min_range", options.min_range, 0.0, options.max_range);
  if (options.voxel_size != 0.0) require_between("voxel_size", options.voxel_size, 0.01, 100.0);
  require_between("max_points_per_voxel", options.max_points_per_voxel, 1, VoxelHashMap::capacity);
  require_between("initial_threshold", options.initial_threshold, 1e-3, 100.0);
  require_between("min_motion", options.min_motion, 0.0, 100.0);
  require_between("max_iterations", options.registration.max_iterations, 1, 100'000);
  require_between("min_update", options.registration.min_update, 0.0, 1.0);
}

Odometry::Odometry(const OdometryOptions& options, ThreadPool& pool)
    : options_((require_valid(options), options)),
      voxel_size_(options.voxel_size > 0.0 ? options.voxel_size : options.max_range / 100.0),
      pool_(pool),
      map_(voxel_size_.meters(), options.max_points_per_voxel),
      threshold_(options.initial_threshold, options.min_motion, options.max_range),
      registration_(options.registration, pool) {
}

std::optional<RegisteredScan> Odometry::register_scan(const Scan& scan) {
  const Rigid3 sweep_start_from_sweep_end = motion_through_sweep(scan);
  const auto motion =
      options_.deskew ? sweep_motion(scan, sweep_start_from_sweep_end) : std::nullopt;
  deskew_and_crop(scan, motion, options_.min_range, options_.max_range, pool_, in_range_);
  if (in_range_.empty()) return std::nullopt;
  thin();
  const bool first = !last_stamp_;
  while (first && fit_voxels(mean_range(thinned_))) thin();

  const double range = mean_range(thinned_);
  const double sigma = threshold_.sigma();
  const Rigid3 predicted = frame_from_last_ * last_motion_;
  const Alignment alignment = registration_.align(source_, map_, predicted, 3.0 * sigma, sigma);

  threshold_.observe(predicted.inverse() * alignment.map_from_lidar);
  move_points(alignment.map_from_lidar, thinned_);
  map_.add(thinned_);
  map_.remove_farther_than(options_.max_range, alignment.map_from_lidar.translation);
  last_motion_ = frame_from_last_.inverse() * alignment.map_from_lidar;
  frame_from_last_ = alignment.map_from_lidar;
  last_interval_ = last_stamp_ ? 1e-9 * static_cast<double>(scan.stamp_ns - *last_stamp_) : 0.0;
  last_stamp_ = scan.stamp_ns;

  RegisteredScan result;
  result.frame_from_lidar = alignment.map_from_lidar;
  result.deskewed = motion.has_value();
  if (motion) result.sweep_start_from_sweep_end = sweep_start_from_sweep_end;
  result.end = alignment.end;
  result.iterations = alignment.iterations;
  result.sigma = sigma;
  result.mean_range = range;
  result.points_in_range = in_range_.size();
  result.map_points = thinned_;
  fit_voxels(range);
  return result;
}

void Odometry::thin() {
  filter_.apply(in_range_, 0.5 * voxel_size_.meters(), thinned_);
  filter_.apply(thinned_, 1.5 * voxel_size_.meters(), source_);
}

bool Odometry::fit_voxels(double mean_range) {
  if (options_.voxel_size > 0.0 || !voxel_size_.observe(mean_range)) return false;
  const std::vector<Eigen::Vector3f> points = map_.points();
  map_ = VoxelHashMap(voxel_size_.meters(), options_.max_points_per_voxel);
  map_.add(points);
  return true;
}

void Odometry::restart_frame() {
  const Rigid3 new_from_old = frame_from_last_.inverse();
  std::vector<Eigen::Vector3f> points = map_.points();
  move_points(new_from_old, points);
  map_.clear();
  map_.add(points);
  frame_from_last_ = Rigid3{};
}

Rigid3 Odometry::motion_through_sweep(const Scan& scan) const {
  const std::optional<TimeSpan> span = time_span(scan);
  if (!span || scan.stamp_is_index || last_interval_ <= 0.0) return last_motion_;
  // The last motion took one scan interval; a sweep may be shorter (scans left out, pauses).
  const double share = static_cast<double>(span->last - span->first) / last_interval_;
  return share >= 1.0 ? last_motion_ : exp(share * log(last_motion_));
}

}  // namespace kissmap
