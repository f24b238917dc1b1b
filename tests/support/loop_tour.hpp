// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <iterator>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "kissmap/loop_closing/loop_closer.hpp"
#include "kissmap/mapping/mapper.hpp"
#include "simulator/simulator.hpp"
#include "support/trajectory_error.hpp"

namespace kissmap {

/// A tour mapped scan by scan with loops closed, and the truth beside it.
class LoopTour {
 public:
  /// Local maps end by the default rule, or by that one.
  explicit LoopTour(SplittingRule rule = {}) : mapper_({}, {}, pool_, std::move(rule)) {}

  void add(const Scan& scan, const simulator::Simulator& simulator) {
    const MapperStep step = mapper_.add(scan);
    const auto& mapped = std::get<MappedScan>(step.scan);
    const Rigid3 true_pose = simulator.map_from_lidar(mapped.pose_stamp_ns);
    if (places_.empty()) true_keyposes_.push_back(true_pose);
    if (step.closed) true_keyposes_.push_back(true_pose);
    odometry_poses_.push_back(mapped.map_from_lidar);
    true_poses_.push_back(true_pose);
    places_.push_back({mapped.local_map_id, mapped.local_map_from_lidar});
    stamps_.push_back(mapped.pose_stamp_ns);
    odometry_[mapped.pose_stamp_ns] = mapped.map_from_lidar.translation;
    truth_[mapped.pose_stamp_ns] = true_pose.translation;
    keep(stretch_builder_.add(thinned_for_stretches(scan), mapped));
    close(step.closed);
  }

  void finish() {
    close(mapper_.finish());
    keep(stretch_builder_.finish());
    loops_.look_again();
    evidence_ = loops_.evidence();
    std::vector<StretchPlace> stretches;
    std::vector<SurfaceLink> scan_links;
    for (const Stretch& stretch : stretches_) {
      stretches.push_back(stretch.place);
      scan_links.insert(scan_links.end(), stretch.scan_links.begin(), stretch.scan_links.end());
    }
    link_surfaces(
        stretches,
        [this](std::size_t i) { return stretches_[i].surfels; },
        scan_links,
        [this](std::span<const SurfaceLink> links) {
          evidence_.surfaces.assign(links.begin(), links.end());
          correction_ = correct_loops(places_, evidence_);
          return correction_.map_from_lidar;
        },
        pool_);
  }

  const std::vector<LocalMap>& local_maps() const { return local_maps_; }
  const std::vector<ScanPlace>& places() const { return places_; }
  const LoopCorrection& correction() const { return correction_; }
  const LoopEvidence& evidence() const { return evidence_; }
  double odometry_ate() const { return trajectory_error(odometry_, truth_).ate; }
  /// What odometry turned by within two seconds, against the truth, at most [rad].
  double odometry_most_turned() const {
    constexpr std::size_t two_seconds = 20;
    double most = 0.0;
    for (std::size_t i = two_seconds; i < true_poses_.size(); ++i) {
      const std::size_t before = i - two_seconds;
      const Rigid3 off = (true_poses_[before].inverse() * true_poses_[i]).inverse() *
                         (odometry_poses_[before].inverse() * odometry_poses_[i]);
      most = std::max(most, off.angle());
    }
    return most;
  }

  double ate(const LoopCorrection& correction) const {
    Positions corrected;
    for (std::size_t i = 0; i < stamps_.size(); ++i) {
      corrected[stamps_[i]] = correction.map_from_lidar[i].translation;
    }
    return trajectory_error(corrected, truth_).ate;
  }

  Rigid3 true_reference_from_query(std::uint32_t reference, std::uint32_t query) const {
    return true_keyposes_[reference].inverse() * true_keyposes_[query];
  }

  /// Ids of local maps that truly show, by the overlap of 40 %, what one not among the three before
  /// them showed.
  std::vector<std::uint32_t> revisits() const {
    std::vector<SurfelMap> maps;
    std::vector<std::uint32_t> ids;
    for (const LocalMap& local_map : local_maps_) {
      maps.emplace_back(local_map.surfels, LocalMapOptions{}.voxel_size);
    }
    for (std::uint32_t query = 4; query < maps.size(); ++query) {
      for (std::uint32_t reference = 0; reference + 4 <= query; ++reference) {
        if (overlap(local_maps_[query].surfels,
                    maps[reference],
                    true_reference_from_query(reference, query)) < 0.4) {
          continue;
        }
        ids.push_back(query);
        break;
      }
    }
    return ids;
  }

  /// Of those revisits.
  std::size_t found(const std::vector<std::uint32_t>& revisits) const {
    const std::vector<Closure> closures = accepted();
    return static_cast<std::size_t>(std::ranges::count_if(revisits, [&](std::uint32_t id) {
      return std::ranges::find(closures, id, &Closure::query_id) != closures.end();
    }));
  }

  /// What a closure is off by where the two local maps meet [m]: keyposes are off by what each
  /// local map is bent.
  double off_by(const Closure& closure) const {
    const Rigid3 truth = true_reference_from_query(closure.reference_id, closure.query_id);
    const Eigen::Vector3d& center = closure.center_in_query;
    return (truth * center - closure.reference_from_query * center).norm();
  }
  /// The same [rad].
  double turned_by(const Closure& closure) const {
    const Rigid3 truth = true_reference_from_query(closure.reference_id, closure.query_id);
    return (truth.inverse() * closure.reference_from_query).angle();
  }

  std::vector<Closure> accepted() const {
    std::vector<Closure> closures;
    std::ranges::copy_if(
        correction_.closures, std::back_inserter(closures), [](const Closure& closure) {
          return closure.verdict == ClosureVerdict::accepted;
        });
    return closures;
  }

 private:
  void keep(std::optional<Stretch> stretch) {
    if (stretch) stretches_.push_back(std::move(*stretch));
  }
  void close(const std::optional<LocalMap>& local_map) {
    if (!local_map) return;
    local_maps_.push_back(*local_map);
    loops_.add(*local_map);
  }

  ThreadPool pool_;
  Mapper mapper_;
  std::vector<LocalMap> local_maps_;
  LoopCloser loops_{{}, LocalMapOptions{}.voxel_size, [this](std::uint32_t id) {
                      return local_maps_[id].surfels;
                    }};
  std::vector<Rigid3> true_keyposes_;
  std::vector<ScanPlace> places_;
  std::vector<Rigid3> odometry_poses_;
  std::vector<Rigid3> true_poses_;
  std::vector<std::int64_t> stamps_;
  Positions odometry_;
  Positions truth_;
  StretchBuilder stretch_builder_{OdometryOptions{}.min_range, OdometryOptions{}.max_range};
  std::vector<Stretch> stretches_;
  LoopEvidence evidence_;
  LoopCorrection correction_;
};

}  // namespace kissmap
