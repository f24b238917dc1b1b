// SPDX-License-Identifier: MIT
#include "kissmap/grid/floor_samples.hpp"

#include <algorithm>
#include <cmath>
#include <tuple>

#include "thinning.hpp"

namespace kissmap {
namespace {

constexpr double slice_height = 0.1;          // m
constexpr double least_below = 0.05;          // m, of floor below the sensor that sees it
constexpr double highest_above = 0.7;         // m, above the sensor, that tells of walls
constexpr float near_range = 8.0F;            // m; beyond, points count less
constexpr float least_weight = 1.5F;          // of a slice: less is noise
constexpr std::size_t enough_points = 16384;  // of a scan
constexpr std::int32_t wall_slices = 3;       // this many in a row are no floor

struct SliceRow {
  Voxel place;
  float z;
  float weight;
};

/// The surface at the foot of rows[begin..end), which are slices upon each other.
FloorSample foot_of(const std::vector<SliceRow>& rows, std::size_t begin, std::size_t end) {
  const bool is_wall = end - begin >= static_cast<std::size_t>(wall_slices);
  // The foot of a wall may lie on either side of a slice's end.
  if (is_wall) end = begin + (rows[begin].weight < 0.5F * rows[begin + 1].weight ? 2 : 1);
  FloorSample sample{rows[begin].place.x, rows[begin].place.y, 0.0F, 0.0F, false};
  for (std::size_t i = begin; i < end; ++i) {
    sample.z += rows[i].weight * rows[i].z;
    sample.weight += rows[i].weight;
  }
  sample.z /= sample.weight;
  return sample;
}

}  // namespace

FloorSampler::FloorSampler(double cell_size, double reach) : cell_size_(cell_size), reach_(reach) {
}

void FloorSampler::add(const PlacedScan& scan, const Rigid3& level_from_map) {
  const Rigid3 level_from_lidar = level_from_map * scan.map_from_lidar;
  const auto reach_squared = static_cast<float>(reach_ * reach_);
  Thinning(scan.points.size(), enough_points).for_each([&](std::size_t i) {
    const float squared = (scan.points[i] - scan.origins[i]).squaredNorm();
    if (!(squared < reach_squared)) return;
    const Eigen::Vector3d point = level_from_lidar * scan.points[i].cast<double>();
    const Eigen::Vector3d origin = level_from_lidar * scan.origins[i].cast<double>();
    const double below = origin.z() - point.z();
    if (!(below > -highest_above)) return;
    const Voxel place{static_cast<std::int32_t>(std::floor(point.x() / cell_size_)),
                      static_cast<std::int32_t>(std::floor(point.y() / cell_size_)),
                      static_cast<std::int32_t>(std::floor(point.z() / slice_height))};
    const float weight =
        squared < near_range * near_range ? 1.0F : near_range * near_range / squared;
    Slice& slice = slices_[voxel_key(place)];
    if (!(below > least_below)) {
      slice.from_below += weight;
      return;
    }
    slice.weight += weight;
    slice.height_sum += weight * static_cast<float>(point.z() - slice_height * place.z);
  });
}

bool FloorSampler::something_above(const Voxel& place) const {
  float weight = 0.0F;
  for (std::int32_t z = place.z + 2; z <= place.z + 6; ++z) {
    const auto slice = slices_.find(voxel_key({place.x, place.y, z}));
    if (slice != slices_.end()) weight += slice->second.weight + slice->second.from_below;
  }
  return weight >= least_weight;
}

std::vector<FloorSample> FloorSampler::samples() const {
  std::vector<SliceRow> rows;
  rows.reserve(slices_.size());
  for (const auto& [key, slice] : slices_) {
    if (slice.weight < least_weight) continue;
    const Voxel place = voxel_from_key(key);
    const auto low = static_cast<float>(slice_height * place.z);
    rows.push_back({place, low + slice.height_sum / slice.weight, slice.weight});
  }
  std::ranges::sort(rows, {}, [](const SliceRow& row) {
    return std::tuple(row.place.x, row.place.y, row.place.z);
  });
  std::vector<FloorSample> samples;
  for (std::size_t begin = 0; begin < rows.size();) {
    std::size_t end = begin + 1;
    while (end < rows.size() && rows[end].place.x == rows[begin].place.x &&
           rows[end].place.y == rows[begin].place.y &&
           rows[end].place.z == rows[end - 1].place.z + 1) {
      ++end;
    }
    samples.push_back(foot_of(rows, begin, end));
    samples.back().below_others = something_above(rows[begin].place);
    begin = end;
  }
  return samples;
}

}  // namespace kissmap
