// SPDX-License-Identifier: MIT
#include "loop_closing/sweep_track.hpp"

#include <algorithm>
#include <utility>

#include "kissmap/mapping/placed_scan.hpp"
#include "kissmap/odometry/preprocess.hpp"
#include "thinning.hpp"

namespace kissmap {
namespace {

constexpr std::size_t stretches_in_window = 3;
constexpr std::size_t most_candidates = 6144;  // points that samples are picked from
constexpr std::size_t most_samples = 1500;
constexpr double sample_voxels = 2.0;              // voxels of the surfels in one of the samples
constexpr int registrations = 2;                   // the second with points deskewed by the first
constexpr double least_pairs = 0.3;                // share of the samples
constexpr GuessSigmas motion_sigmas{0.02, 0.012};  // of odometry from one middle to the next
constexpr double most_sweeps_apart = 3.0;
// Of a registration's information: scans placed on the same surfaces share their errors.
constexpr double share_of_information = 0.3;

Rigid3 part_of(double share, const Rigid3& motion) {
  return exp(share * log(motion));
}

/// Moves points to another frame.
void transform(const Rigid3& to_from_points, std::vector<Eigen::Vector3f>& points) {
  const Eigen::Matrix3f rotation = to_from_points.rotation.toRotationMatrix().cast<float>();
  const Eigen::Vector3f translation = to_from_points.translation.cast<float>();
  for (Eigen::Vector3f& point : points) point = rotation * point + translation;
}

void transform(const Rigid3& to_from_surfels, SurfelCloud& surfels) {
  transform(to_from_surfels, surfels.means);
  transform({to_from_surfels.rotation, Eigen::Vector3d::Zero()}, surfels.normals);
}

}  // namespace

SweepTrack::SweepTrack(double min_range, double max_range)
    : min_range_(min_range), max_range_(max_range) {
}

void SweepTrack::place(const Scan& scan, const MappedScan& mapped, double voxel_size) {
  Sweep sweep = predict(scan, mapped);
  const Rigid3 predicted = sweep.anchor_from_middle;
  if (surfaces_ && !register_sweep(scan, voxel_size, sweep)) {
    sweep.anchor_from_middle = predicted;
    sweep.information.reset();
  }
  deskew(scan, sweep, scan.points.size());
  transform(sweep.anchor_from_middle, points_);
  add(std::move(sweep));
}

void SweepTrack::follow(const Scan& scan, const MappedScan& mapped) {
  add(predict(scan, mapped));
  points_.clear();
}

SweepTrack::Sweep SweepTrack::predict(const Scan& scan, const MappedScan& mapped) {
  Sweep sweep;
  sweep.scan = scans_++;
  sweep.end = 1e-9 * static_cast<double>(mapped.pose_stamp_ns);
  const std::optional<TimeSpan> span = time_span(scan);
  if (mapped.deskewed && span) {
    sweep.seconds = static_cast<double>(span->last) - static_cast<double>(span->first);
    sweep.start_from_end =
        sweep_start_from_sweep_end(before_ ? &*before_ : nullptr, mapped, sweep.seconds);
  }
  const Rigid3 map_from_middle = mapped.map_from_lidar * part_of(-0.5, sweep.start_from_end);
  sweep.anchor_from_middle =
      sweeps_.empty()
          ? part_of(-0.5, sweep.start_from_end)
          : sweeps_.back().anchor_from_middle * (map_from_last_middle_.inverse() * map_from_middle);
  map_from_last_middle_ = map_from_middle;
  before_ = mapped;
  return sweep;
}

bool SweepTrack::register_sweep(const Scan& scan, double voxel_size, Sweep& sweep) {
  for (int i = 0; i < registrations; ++i) {
    deskew(scan, sweep, most_candidates);
    filter_.apply(points_, sample_voxels * voxel_size, samples_);
    // Strewn over the scan: the filter's order is that of hashes.
    if (samples_.size() > most_samples) samples_.resize(most_samples);
    const SurfelAlignment fit =
        register_points(samples_, *surfaces_, sweep.anchor_from_middle, motion_sigmas);
    if (!fit.converged || fit.pairs < least_pairs * fit.samples) return false;
    sweep.anchor_from_middle = fit.reference_from_query;
    sweep.information = information_of(fit);
  }
  return true;
}

void SweepTrack::add(Sweep sweep) {
  sweeps_.push_back(std::move(sweep));
  if (sweeps_.size() > 1) link(sweeps_.size() - 2);
}

void SweepTrack::finish() {
  if (!sweeps_.empty()) link(sweeps_.size() - 1);
}

void SweepTrack::link(std::size_t index) {
  const Sweep& sweep = sweeps_[index];
  if (!sweep.information || sweep.scan == anchor_scan_) return;
  links_.push_back({anchor_scan_,
                    sweep.scan,
                    anchor_from_end(index),
                    share_of_information * *sweep.information});
}

std::vector<SurfaceLink> SweepTrack::take_links() {
  return std::exchange(links_, {});
}

void SweepTrack::deskew(const Scan& scan, const Sweep& sweep, std::size_t most) {
  const Rigid3 motion = start_from_end(sweep);
  const auto to_end = sweep.seconds > 0.0 ? sweep_motion(scan, motion) : std::nullopt;
  const Rigid3 middle_from_end = part_of(0.5, motion);
  const Eigen::Matrix3f rotation = middle_from_end.rotation.toRotationMatrix().cast<float>();
  const Eigen::Vector3f translation = middle_from_end.translation.cast<float>();
  const auto nearest = static_cast<float>(min_range_ * min_range_);
  const auto farthest = static_cast<float>(max_range_ * max_range_);
  points_.clear();
  Thinning(scan.points.size(), most).for_each([&](std::size_t i) {
    const float squared = scan.points[i].squaredNorm();
    if (!(squared > nearest && squared < farthest)) return;
    points_.push_back(
        to_end ? rotation * to_end->to_sweep_end(scan.points[i], scan.time_offsets[i]) + translation
               : scan.points[i]);
  });
}

bool SweepTrack::adjoin(const Sweep& before, const Sweep& after) {
  return after.end > before.end && after.end - before.end < most_sweeps_apart * after.seconds;
}

Rigid3 SweepTrack::start_from_end(const Sweep& sweep) const {
  if (sweeps_.empty() || !adjoin(sweeps_.back(), sweep)) return sweep.start_from_end;
  const Sweep& before = sweeps_.back();
  return part_of(sweep.seconds / (sweep.end - before.end),
                 before.anchor_from_middle.inverse() * sweep.anchor_from_middle);
}

Rigid3 SweepTrack::anchor_from_end(std::size_t index) const {
  const Sweep& sweep = sweeps_[index];
  if (sweep.seconds <= 0.0) return sweep.anchor_from_middle;
  const Sweep* before =
      index > 0 && adjoin(sweeps_[index - 1], sweep) ? &sweeps_[index - 1] : &sweep;
  const Sweep* after = index + 1 < sweeps_.size() && adjoin(sweep, sweeps_[index + 1])
                           ? &sweeps_[index + 1]
                           : &sweep;
  if (before == after) return sweep.anchor_from_middle * part_of(0.5, sweep.start_from_end);
  return sweep.anchor_from_middle *
         part_of(0.5 * sweep.seconds / (after->end - before->end),
                 before->anchor_from_middle.inverse() * after->anchor_from_middle);
}

void SweepTrack::end_stretch(std::uint32_t middle_scan, double voxel_size, SurfelCloud& surfels) {
  const std::size_t middle = middle_scan - sweeps_.front().scan;
  const Rigid3 new_from_old = anchor_from_end(middle).inverse();
  anchor_scan_ = middle_scan;
  for (Sweep& sweep : sweeps_) sweep.anchor_from_middle = new_from_old * sweep.anchor_from_middle;
  for (SurfelCloud& others : window_) transform(new_from_old, others);
  transform(new_from_old, surfels);
  while (sweeps_.size() > 2) sweeps_.pop_front();
  window_.push_front(surfels);
  if (window_.size() > stretches_in_window) window_.pop_back();
  SurfelCloud all;  // the latest first: theirs is the surfel of a voxel
  for (const SurfelCloud& part : window_) {
    all.means.insert(all.means.end(), part.means.begin(), part.means.end());
    all.normals.insert(all.normals.end(), part.normals.begin(), part.normals.end());
  }
  surfaces_.emplace(all, voxel_size);
}

}  // namespace kissmap
