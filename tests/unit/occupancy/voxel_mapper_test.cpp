// SPDX-License-Identifier: MIT
#include "kissmap/occupancy/voxel_mapper.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "kissmap/error.hpp"
#include "unit/occupancy/ray_oracle.hpp"

namespace kissmap {
namespace {

constexpr double half = 3.0;  // m, from the middle of a cubic room to its walls

/// Where a ray from `start`, inside the room, meets its walls.
Eigen::Vector3d at_wall(const Eigen::Vector3d& start, const Eigen::Vector3d& direction) {
  double range = std::numeric_limits<double>::infinity();
  for (int a = 0; a < 3; ++a) {
    const double wall = direction[a] > 0.0 ? half : -half;
    if (std::abs(direction[a]) > 1e-9) range = std::min(range, (wall - start[a]) / direction[a]);
  }
  return start + range * direction;
}

/// A room seen from a sensor that is turned, and 0.4 m further back when it saw each second point.
PlacedScan room_scan() {
  PlacedScan scan;
  scan.map_from_lidar.rotation = Eigen::AngleAxisd(0.7, Eigen::Vector3d(0.1, 0.2, 1).normalized());
  scan.map_from_lidar.translation = {0.3, -0.2, 0.1};
  const Rigid3 lidar_from_map = scan.map_from_lidar.inverse();
  for (int ring = -20; ring <= 20; ++ring) {
    for (int column = 0; column < 360; ++column) {
      const double up = ring * 0.03;
      const double yaw = column * std::numbers::pi / 180.0;
      const Eigen::Vector3d direction(
          std::cos(up) * std::cos(yaw), std::cos(up) * std::sin(yaw), std::sin(up));
      const Eigen::Vector3d origin =
          scan.map_from_lidar.translation - Eigen::Vector3d(column % 2 == 0 ? 0.0 : 0.4, 0.0, 0.0);
      scan.origins.push_back((lidar_from_map * origin).cast<float>());
      scan.points.push_back((lidar_from_map * at_wall(origin, direction)).cast<float>());
    }
  }
  return scan;
}

OccupancyGeometry fine() {
  return {Eigen::Vector3d::Zero(), Eigen::Vector3d::Constant(0.1), std::nullopt};
}

double reach_of(const OccupancyMap& map, const Voxel& voxel) {
  return voxel_center(map.geometry(), voxel).cwiseAbs().maxCoeff();
}

TEST(VoxelMapper, WallsAreOccupiedAndTheRoomIsFree) {
  VoxelMapper mapper(fine());
  ThreadPool pool(1);
  const PlacedScan scan = room_scan();
  const OccupancyUpdate update = mapper.add(scan, pool);
  EXPECT_EQ(update.rays, scan.points.size());
  std::size_t occupied = 0;
  std::size_t free = 0;
  mapper.map().for_each_voxel([&](const Voxel& voxel, LogOdds value) {
    const double reach = reach_of(mapper.map(), voxel);
    if (mapper.map().steps().is_occupied(value)) {
      ++occupied;
      ASSERT_NEAR(reach, half, 0.0501) << "one voxel to either side of the wall";
    } else {
      ++free;
      ASSERT_LT(reach, half);
    }
  });
  EXPECT_GT(occupied, 3'000U);
  EXPECT_GT(free, 60'000U);
  EXPECT_TRUE(mapper.map().is_free(*voxel_at(fine(), {0.3, -0.2, 0.1})));
  // Only the sensor that stood further back has seen what is behind the other.
  EXPECT_TRUE(mapper.map().is_free(*voxel_at(fine(), {-0.05, -0.2, 0.1})));
}

TEST(VoxelMapper, RaysWithoutReturnClearOnlyWhereAskedTo) {
  PlacedScan scan;
  scan.no_return_directions = {{1.0F, 0.0F, 0.0F}};
  scan.no_return_origins = {{0.05F, 0.05F, 0.05F}};
  ThreadPool pool(1);
  VoxelMapper silent(fine());
  silent.add(scan, pool);
  EXPECT_EQ(silent.map().block_count(), 0U);
  VoxelMapperOptions options;
  options.no_return_range = 2.0;
  VoxelMapper clearing(fine(), options);
  clearing.add(scan, pool);
  for (std::int32_t x = 0; x < 20; ++x) ASSERT_TRUE(clearing.map().is_free({x, 0, 0})) << x;
  EXPECT_EQ(clearing.map().at({21, 0, 0}), unknown_log_odds);
  options.no_return_range = -1.0;
  EXPECT_THROW(VoxelMapper(fine(), options), Error);
}

TEST(VoxelMapper, APartOfTheMapIsWhatItIsInTheWhole) {
  const PlacedScan scan = room_scan();
  PlacedScan later = scan;
  later.map_from_lidar.translation.x() += 1.7;
  for (const bool one_ray : {false, true}) {
    VoxelMapperOptions options;
    options.occupancy.one_ray_per_end_voxel = one_ray;
    ThreadPool pool(2);
    VoxelMapper whole(fine(), options);
    for (const PlacedScan& s : {scan, later}) whole.add(s, pool);
    const TileBox box{-1, 0, 0, 1};
    VoxelMapper from_start(fine(), options);
    from_start.map().restrict_to(box);
    VoxelMapper from_half(fine(), options);
    from_half.add(scan, pool);
    from_half.map().restrict_to(box);
    from_half.add(later, pool);
    for (const PlacedScan& s : {scan, later}) from_start.add(s, pool);
    std::size_t compared = 0;
    whole.map().for_each_voxel([&](const Voxel& voxel, LogOdds value) {
      const bool kept = box.contains({voxel.x >> 6, voxel.y >> 6, voxel.z >> 6});
      const LogOdds wanted = kept ? value : unknown_log_odds;
      compared += kept ? 1 : 0;
      ASSERT_EQ(from_start.map().at(voxel), wanted);
      ASSERT_EQ(from_half.map().at(voxel), wanted);
    });
    EXPECT_GT(compared, 10'000U);
    EXPECT_EQ(from_start.map().block_count(), from_half.map().block_count());
    for (const Voxel& tile : from_half.map().tiles()) EXPECT_TRUE(box.contains(tile));
    EXPECT_LT(from_half.map().memory_bytes(), whole.map().memory_bytes() / 2);
    EXPECT_FALSE(from_half.map().tiles().empty());
  }
}

}  // namespace
}  // namespace kissmap
