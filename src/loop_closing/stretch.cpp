// SPDX-License-Identifier: MIT
#include "kissmap/loop_closing/stretch.hpp"

#include <algorithm>

#include "kissmap/mapping/surfels.hpp"
#include "kissmap/odometry/voxel_hash_map.hpp"
#include "loop_closing/sweep_track.hpp"
#include "thinning.hpp"

namespace kissmap {
namespace {

constexpr double length_per_range = 0.15;
constexpr double shortest = 0.4;   // m
constexpr double longest = 5.0;    // m
constexpr double most_turn = 0.4;  // rad
constexpr double voxel_per_range = 0.05;
constexpr double smallest_voxel = 0.15;  // m
constexpr double largest_voxel = 0.5;    // m
// While the sensor stands, scans after these show nothing new.
constexpr std::uint32_t most_scans = 60;
constexpr std::size_t most_points = 12288;

double mean_range_of(const Scan& scan) {
  if (scan.points.empty()) return 0.0;
  double sum = 0.0;
  for (const Eigen::Vector3f& point : scan.points) sum += static_cast<double>(point.norm());
  return sum / static_cast<double>(scan.points.size());
}

Eigen::Vector3d center_of(const SurfelCloud& surfels) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const Eigen::Vector3f& mean : surfels.means) sum += mean.cast<double>();
  return sum / static_cast<double>(std::max<std::size_t>(1, surfels.size()));
}

}  // namespace

class StretchBuilder::Impl {
 public:
  Impl(double min_range, double max_range) : track_(min_range, max_range) {}

  std::optional<Stretch> add(const Scan& scan, const MappedScan& mapped) {
    std::optional<Stretch> closed;
    if (grid_) {
      const Rigid3 motion = map_from_last_.inverse() * mapped.map_from_lidar;
      way_ += motion.translation.norm();
      turn_ += motion.angle();
      if (is_long_enough()) closed = close();
    }
    map_from_last_ = mapped.map_from_lidar;
    if (!grid_) begin(scan);
    if (scans_ - place_.first_scan < most_scans) {
      track_.place(scan, mapped, place_.voxel_size);
      grid_->add(track_.points_in_anchor());
    } else {
      track_.follow(scan, mapped);
    }
    ++scans_;
    return closed;
  }

  std::optional<Stretch> finish() {
    if (!grid_) return std::nullopt;
    track_.finish();
    return close();
  }

 private:
  void begin(const Scan& scan) {
    place_.first_scan = scans_;
    place_.mean_range = mean_range_of(scan);
    place_.voxel_size =
        std::clamp(voxel_per_range * place_.mean_range, smallest_voxel, largest_voxel);
    grid_.emplace(place_.voxel_size, VoxelHashMap::capacity);
    way_ = 0.0;
    turn_ = 0.0;
  }

  bool is_long_enough() const {
    const double length = std::clamp(length_per_range * place_.mean_range, shortest, longest);
    return way_ > length || turn_ > most_turn;
  }

  Stretch close() {
    place_.end_scan = scans_;
    place_.middle_scan = place_.first_scan + (place_.end_scan - place_.first_scan - 1) / 2;
    Stretch stretch{place_, surfels_from_grid(*grid_), {}};
    grid_.reset();
    stretch.scan_links = track_.take_links();
    track_.end_stretch(place_.middle_scan, place_.voxel_size, stretch.surfels);
    stretch.place.center = center_of(stretch.surfels);
    return stretch;
  }

  SweepTrack track_;
  std::optional<VoxelHashMap> grid_;  ///< of the open stretch, in the track's frame
  StretchPlace place_;
  double way_ = 0.0;   ///< m
  double turn_ = 0.0;  ///< rad
  std::uint32_t scans_ = 0;
  Rigid3 map_from_last_;
};

StretchBuilder::StretchBuilder(double min_range, double max_range)
    : impl_(std::make_unique<Impl>(min_range, max_range)) {
}

StretchBuilder::~StretchBuilder() = default;
StretchBuilder::StretchBuilder(StretchBuilder&&) noexcept = default;
StretchBuilder& StretchBuilder::operator=(StretchBuilder&&) noexcept = default;

std::optional<Stretch> StretchBuilder::add(const Scan& scan, const MappedScan& mapped) {
  return impl_->add(scan, mapped);
}

std::optional<Stretch> StretchBuilder::finish() {
  return impl_->finish();
}

Scan thinned_for_stretches(const Scan& scan) {
  Scan thinned;
  thinned.stamp_ns = scan.stamp_ns;
  thinned.stamp_is_index = scan.stamp_is_index;
  thinned.stamp_instant = scan.stamp_instant;
  thinned.compensation = scan.compensation;
  thinned.time_source = scan.time_source;
  Thinning(scan.points.size(), most_points).for_each([&](std::size_t i) {
    thinned.points.push_back(scan.points[i]);
    if (!scan.time_offsets.empty()) thinned.time_offsets.push_back(scan.time_offsets[i]);
  });
  return thinned;
}

}  // namespace kissmap
