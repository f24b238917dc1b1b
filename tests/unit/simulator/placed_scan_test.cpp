// SPDX-License-Identifier: MIT
// Scans placed by a trajectory, against the simulator, which knows where each shot began and hit.
#include "kissmap/mapping/placed_scan.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "kissmap/odometry/preprocess.hpp"
#include "simulator/scenario.hpp"
#include "simulator/simulator.hpp"

namespace kissmap::simulator {
namespace {

constexpr double min_range = 1.0;
constexpr double max_range = 40.0;

/// Scan i as a mapper without error would place it.
MappedScan true_place(const Simulator& simulator, std::size_t scan_idx) {
  const Scan scan = simulator.scan(scan_idx);
  MappedScan mapped;
  mapped.stamp_ns = scan.stamp_ns;
  mapped.pose_stamp_ns =
      scan.stamp_ns + std::llround(1e9 * static_cast<double>(time_span(scan)->last));
  mapped.map_from_lidar = simulator.map_from_lidar(mapped.pose_stamp_ns);
  mapped.deskewed = true;
  return mapped;
}

class PlacedScanOfACar : public testing::Test {
 protected:
  PlacedScanOfACar()
      : simulator_(make_simulator({"town", "spinning16", "car", 1, 200, 300, 1.0})) {}
  Simulator simulator_;
};

TEST_F(PlacedScanOfACar, PointsAndSensorAreWhereTheyWere) {
  for (std::size_t i = 40; i < 200; i += 40) {
    const MappedScan before = true_place(simulator_, i - 1);
    const MappedScan mapped = true_place(simulator_, i);
    const Scan scan = simulator_.scan(i);
    const PlacedScan placed = place_scan(scan, &before, mapped, 0.0, 1000.0);
    ASSERT_EQ(placed.points.size(), scan.points.size());
    ASSERT_EQ(placed.origins.size(), scan.points.size());
    ASSERT_EQ(placed.time_offsets.size(), scan.points.size());
    ASSERT_EQ(placed.intensities.size(), scan.points.size());
    double worst_origin = 0.0;
    float worst_range = 0.0F;
    for (std::size_t k = 0; k < scan.points.size(); ++k) {
      const std::int64_t stamp =
          scan.stamp_ns + std::llround(1e9 * static_cast<double>(scan.time_offsets[k]));
      ASSERT_NEAR(
          placed.time_offsets[k], 1e-9 * static_cast<double>(stamp - placed.pose_stamp_ns), 1e-6);
      const Eigen::Vector3d origin = placed.map_from_lidar * placed.origins[k].cast<double>();
      worst_origin =
          std::max(worst_origin, (origin - simulator_.map_from_lidar(stamp).translation).norm());
      // A rigid motion keeps the range of each shot.
      const float range = (placed.points[k] - placed.origins[k]).norm();
      worst_range = std::max(worst_range, std::abs(range - scan.points[k].norm()));
    }
    // In 0.1 s, 2 m/s^2 leave 2.5 mm of the constant velocity.
    EXPECT_LT(worst_origin, 0.01);
    EXPECT_LT(worst_range, 1e-3F);
    const PlacedScan cropped = place_scan(scan, &before, mapped, min_range, max_range);
    EXPECT_LT(cropped.points.size(), placed.points.size());
    for (const Eigen::Vector3f& point : cropped.points) {
      ASSERT_GT(point.norm(), min_range);
      ASSERT_LT(point.norm(), max_range);
    }
  }
}

TEST_F(PlacedScanOfACar, PointsLieOnSurfaces) {
  const MappedScan before = true_place(simulator_, 99);
  const MappedScan mapped = true_place(simulator_, 100);
  const PlacedScan placed = place_scan(simulator_.scan(100), &before, mapped, min_range, max_range);
  const double time = 1e-9 * static_cast<double>(mapped.pose_stamp_ns - Simulator::first_stamp_ns);
  std::size_t off = 0;
  for (std::size_t k = 0; k < placed.points.size(); k += 10) {
    const Eigen::Vector3d point = placed.map_from_lidar * placed.points[k].cast<double>();
    const double at = time + static_cast<double>(placed.time_offsets[k]);
    // Range noise, and what a turn leaves at 40 m.
    if (std::abs(simulator_.caster().distance(point, at)) > 0.12) ++off;
  }
  EXPECT_LE(100 * off, placed.points.size() / 10);
}

TEST_F(PlacedScanOfACar, DirectionsWithoutReturnStartWhereTheSensorWas) {
  const MappedScan before = true_place(simulator_, 99);
  const MappedScan mapped = true_place(simulator_, 100);
  const Scan scan = simulator_.scan(100);
  PlacedScan placed = place_scan(scan, &before, mapped, min_range, max_range);
  EXPECT_TRUE(placed.no_return_directions.empty());
  place_no_returns(scan, &before, mapped, placed);
  ASSERT_EQ(placed.no_return_directions.size(), scan.no_return_directions.size());
  ASSERT_GT(placed.no_return_directions.size(), 100U);
  ASSERT_EQ(placed.no_return_origins.size(), placed.no_return_directions.size());
  for (const Eigen::Vector3f& direction : placed.no_return_directions) {
    ASSERT_NEAR(direction.norm(), 1.0F, 1e-5F);
  }
}

TEST(SweepMotion, IsThatOfTheTrajectoryUnlessTheScanBeforeIsFarBack) {
  MappedScan before;
  MappedScan mapped;
  mapped.pose_stamp_ns = 200'000'000;
  mapped.map_from_lidar.translation = {4.0, 0.0, 0.0};
  mapped.sweep_start_from_sweep_end.translation = {9.0, 0.0, 0.0};
  const auto length = [&](const MappedScan* last) {
    return sweep_start_from_sweep_end(last, mapped, 0.1).translation.x();
  };
  EXPECT_NEAR(length(&before), 2.0, 1e-12) << "half of the way, in half of the time";
  EXPECT_EQ(length(nullptr), 9.0);
  mapped.pose_stamp_ns = 400'000'000;
  EXPECT_EQ(length(&before), 9.0);
  mapped.pose_stamp_ns = before.pose_stamp_ns;
  EXPECT_EQ(length(&before), 9.0);
}

TEST(PlacedScanTest, WithoutTimesAllIsSeenFromOnePlace) {
  Scan scan;
  scan.points = {{2.0F, 0.0F, 0.0F}, {0.1F, 0.0F, 0.0F}, {0.0F, 3.0F, 0.0F}, {90.0F, 0.0F, 0.0F}};
  const PlacedScan placed = place_scan(scan, nullptr, {}, min_range, max_range);
  ASSERT_EQ(placed.points.size(), 2U);
  EXPECT_EQ(placed.points[1], scan.points[2]);
  EXPECT_EQ(placed.origins, std::vector<Eigen::Vector3f>(2, Eigen::Vector3f::Zero()));
  EXPECT_TRUE(placed.time_offsets.empty());
  EXPECT_TRUE(placed.intensities.empty());
}

}  // namespace
}  // namespace kissmap::simulator
