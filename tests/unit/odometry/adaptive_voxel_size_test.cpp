// SPDX-License-Identifier: MIT
#include "kissmap/odometry/adaptive_voxel_size.hpp"

#include <gtest/gtest.h>

#include <algorithm>

namespace kissmap {
namespace {

// Thinned to half a voxel, as odometry observes: finer voxels keep more of the near points.
double observed_range(double scene, double voxel_size) {
  return scene * (0.7 + 0.3 * voxel_size);
}

int changes(AdaptiveVoxelSize& voxel_size, double scene, int scans) {
  int count = 0;
  for (int i = 0; i < scans; ++i) {
    count += voxel_size.observe(observed_range(scene, voxel_size.meters())) ? 1 : 0;
  }
  return count;
}

TEST(AdaptiveVoxelSize, StaysAsItIsOnStreets) {
  AdaptiveVoxelSize voxel_size(1.0);
  EXPECT_EQ(changes(voxel_size, 20.0, 1000), 0);
  EXPECT_DOUBLE_EQ(voxel_size.meters(), 1.0);
}

TEST(AdaptiveVoxelSize, IsHalvedTwiceInRoomsAndNotMore) {
  AdaptiveVoxelSize voxel_size(1.0);
  changes(voxel_size, 1.0, 1000);
  EXPECT_DOUBLE_EQ(voxel_size.meters(), 0.25);
}

TEST(AdaptiveVoxelSize, SettlesWhateverTheScene) {
  for (double scene = 0.5; scene < 100.0; scene *= 1.07) {
    AdaptiveVoxelSize voxel_size(1.0);
    changes(voxel_size, scene, 100);
    EXPECT_EQ(changes(voxel_size, scene, 1000), 0) << scene << " m";
  }
}

TEST(AdaptiveVoxelSize, ComesBackInTheOpen) {
  AdaptiveVoxelSize voxel_size(1.0);
  changes(voxel_size, 4.0, 200);
  ASSERT_DOUBLE_EQ(voxel_size.meters(), 0.25);
  EXPECT_EQ(changes(voxel_size, 40.0, 200), 2);
  EXPECT_DOUBLE_EQ(voxel_size.meters(), 1.0);
}

TEST(AdaptiveVoxelSize, OneScanChangesNothing) {
  AdaptiveVoxelSize voxel_size(1.0);
  changes(voxel_size, 25.0, 100);
  EXPECT_FALSE(voxel_size.observe(0.5)) << "something held before the sensor";
  EXPECT_EQ(changes(voxel_size, 25.0, 100), 0);
}

TEST(AdaptiveVoxelSize, ScalesWithTheCoarsestVoxel) {
  AdaptiveVoxelSize one(1.0);
  AdaptiveVoxelSize half(0.5);
  for (double range = 30.0; range > 0.5; range *= 0.99) {
    one.observe(range);
    half.observe(0.5 * range);
    EXPECT_DOUBLE_EQ(half.meters(), 0.5 * one.meters());
  }
}

}  // namespace
}  // namespace kissmap
