// SPDX-License-Identifier: MIT
#include "kissmap/mapping/stretch.hpp"

#include <algorithm>

#include "kissmap/mapping/placed_scan.hpp"
#include "kissmap/mapping/surfels.hpp"

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
constexpr std::size_t most_scans = 60;
constexpr std::size_t most_points = 16384;

double mean_range_of(const Scan& scan) {
  if (scan.points.empty()) return 0.0;
  double sum = 0.0;
  for (const Eigen::Vector3f& point : scan.points) sum += static_cast<double>(point.norm());
  return sum / static_cast<double>(scan.points.size());
}

void add_points(const std::vector<Eigen::Vector3f>& points,
                const Rigid3& grid_from_points,
                VoxelHashMap& grid) {
  const Eigen::Matrix3f rotation = grid_from_points.rotation.toRotationMatrix().cast<float>();
  const Eigen::Vector3f translation = grid_from_points.translation.cast<float>();
  std::vector<Eigen::Vector3f> moved;
  moved.reserve(points.size());
  for (const Eigen::Vector3f& point : points) moved.emplace_back(rotation * point + translation);
  grid.add(moved);
}

void transform(const Rigid3& to_from_surfels, SurfelCloud& surfels) {
  const Eigen::Matrix3f rotation = to_from_surfels.rotation.toRotationMatrix().cast<float>();
  const Eigen::Vector3f translation = to_from_surfels.translation.cast<float>();
  for (Eigen::Vector3f& mean : surfels.means) mean = rotation * mean + translation;
  for (Eigen::Vector3f& normal : surfels.normals) normal = rotation * normal;
}

}  // namespace

StretchBuilder::StretchBuilder(double min_range, double max_range)
    : min_range_(min_range), max_range_(max_range) {
}

std::optional<Stretch> StretchBuilder::add(const Scan& scan, const MappedScan& mapped) {
  std::optional<Stretch> closed;
  if (grid_) {
    const Rigid3 motion = before_->map_from_lidar.inverse() * mapped.map_from_lidar;
    way_ += motion.translation.norm();
    turn_ += motion.angle();
    first_from_scan_.push_back(first_from_scan_.back() * motion);
    if (is_long_enough()) {
      first_from_scan_.pop_back();
      closed = close();
    }
  }
  if (!grid_) begin(scan);
  if (first_from_scan_.size() <= most_scans) {
    const PlacedScan placed =
        place_scan(scan, before_ ? &*before_ : nullptr, mapped, min_range_, max_range_);
    add_points(placed.points, first_from_scan_.back(), *grid_);
  }
  before_ = mapped;
  ++scans_;
  return closed;
}

std::optional<Stretch> StretchBuilder::finish() {
  if (!grid_) return std::nullopt;
  return close();
}

void StretchBuilder::begin(const Scan& scan) {
  place_.first_scan = scans_;
  place_.mean_range = mean_range_of(scan);
  place_.voxel_size =
      std::clamp(voxel_per_range * place_.mean_range, smallest_voxel, largest_voxel);
  grid_.emplace(place_.voxel_size, VoxelHashMap::capacity);
  first_from_scan_.assign(1, Rigid3{});
  way_ = 0.0;
  turn_ = 0.0;
}

bool StretchBuilder::is_long_enough() const {
  const double length = std::clamp(length_per_range * place_.mean_range, shortest, longest);
  return way_ > length || turn_ > most_turn;
}

Stretch StretchBuilder::close() {
  place_.end_scan = place_.first_scan + static_cast<std::uint32_t>(first_from_scan_.size());
  place_.middle_scan = place_.first_scan + (place_.end_scan - place_.first_scan) / 2;
  Stretch stretch{place_, surfels_from_grid(*grid_)};
  transform(first_from_scan_[place_.middle_scan - place_.first_scan].inverse(), stretch.surfels);
  grid_.reset();
  return stretch;
}

Scan thinned_for_stretches(const Scan& scan) {
  const std::size_t step = 1 + scan.points.size() / (most_points + 1);
  Scan thinned;
  thinned.stamp_ns = scan.stamp_ns;
  thinned.stamp_is_index = scan.stamp_is_index;
  thinned.stamp_instant = scan.stamp_instant;
  thinned.compensation = scan.compensation;
  thinned.time_source = scan.time_source;
  for (std::size_t i = 0; i < scan.points.size(); i += step) {
    thinned.points.push_back(scan.points[i]);
    if (!scan.time_offsets.empty()) thinned.time_offsets.push_back(scan.time_offsets[i]);
  }
  return thinned;
}

}  // namespace kissmap
