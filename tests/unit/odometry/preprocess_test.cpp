// SPDX-License-Identifier: MIT
#include "kissmap/odometry/preprocess.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "support/random_clouds.hpp"

namespace kissmap {
namespace {

/// A static cloud as a sensor in constant-velocity motion records it: exact, point by point.
struct MovingSensor {
  Rigid3 start_from_end;
  double sweep = 0.1;

  Scan record(const std::vector<Eigen::Vector3f>& in_end_frame, double first_offset) const {
    Scan scan;
    scan.time_source = TimeSource::recorded;
    scan.compensation = Compensation::no;
    for (std::size_t i = 0; i < in_end_frame.size(); ++i) {
      const double s = static_cast<double>(i) / static_cast<double>(in_end_frame.size() - 1);
      const Rigid3 end_from_now = exp((s - 1.0) * log(start_from_end));
      scan.points.push_back(
          (end_from_now.inverse() * in_end_frame[i].cast<double>()).cast<float>());
      scan.time_offsets.push_back(static_cast<float>(first_offset + s * sweep));
    }
    return scan;
  }
};

std::vector<Eigen::Vector3f> preprocess(const Scan& scan, const Rigid3& motion, int threads = 1) {
  ThreadPool pool(threads);
  std::vector<Eigen::Vector3f> kept;
  deskew_and_crop(scan, sweep_motion(scan, motion), 0.0, 100.0, pool, kept);
  return kept;
}

MovingSensor fast_turn() {
  Twist twist;
  twist << 2.0, -0.3, 0.1, 0.02, -0.05, 0.3;
  return {exp(twist)};
}

TEST(Deskew, UndoesConstantVelocityMotionExactly) {
  std::mt19937 random(31);
  const MovingSensor sensor = fast_turn();
  const auto truth = uniform_cloud(random, 5000, 50.0F);
  for (const double first_offset : {0.0, -0.1, -0.05, 12.0}) {
    const auto deskewed = preprocess(sensor.record(truth, first_offset), sensor.start_from_end);
    ASSERT_EQ(deskewed.size(), truth.size());
    double worst = 0.0;
    for (std::size_t i = 0; i < truth.size(); ++i) {
      worst = std::max(worst, static_cast<double>((deskewed[i] - truth[i]).norm()));
    }
    // Offsets near 12 s are floats with 1 us steps: 2 m in 0.1 s, so 20 um more.
    EXPECT_LT(worst, 2e-4) << "offsets from " << first_offset;
  }
}

TEST(Deskew, LeavesScansAloneThatHaveNoUsableTimes) {
  std::mt19937 random(32);
  const MovingSensor sensor = fast_turn();
  Scan scan = sensor.record(uniform_cloud(random, 100, 30.0F), 0.0);
  const auto recorded = scan.points;

  Scan compensated = scan;
  compensated.compensation = Compensation::yes;
  EXPECT_EQ(preprocess(compensated, sensor.start_from_end), recorded);

  Scan equal_times = scan;
  std::ranges::fill(equal_times.time_offsets, 0.05F);
  EXPECT_EQ(preprocess(equal_times, sensor.start_from_end), recorded);

  Scan no_times = scan;
  no_times.time_offsets.clear();
  no_times.time_source = TimeSource::none;
  EXPECT_EQ(preprocess(no_times, sensor.start_from_end), recorded);
}

TEST(Crop, KeepsTheOpenRangeIntervalInOrder) {
  Scan scan;
  for (const float x : {0.5F, 1.0F, 1.5F, 99.0F, 100.0F, 101.0F}) scan.points.emplace_back(x, 0, 0);
  ThreadPool pool(1);
  std::vector<Eigen::Vector3f> kept;
  deskew_and_crop(scan, std::nullopt, 1.0, 100.0, pool, kept);
  const std::vector<Eigen::Vector3f> expected{{1.5F, 0, 0}, {99.0F, 0, 0}};
  EXPECT_EQ(kept, expected);
}

TEST(Preprocess, SameResultForAnyNumberOfThreads) {
  std::mt19937 random(33);
  const MovingSensor sensor = fast_turn();
  const Scan scan = sensor.record(uniform_cloud(random, 150'000, 80.0F), 0.0);
  const auto alone = preprocess(scan, sensor.start_from_end, 1);
  EXPECT_LT(alone.size(), scan.points.size());
  for (const int threads : {2, 3, 8}) {
    EXPECT_EQ(preprocess(scan, sensor.start_from_end, threads), alone) << threads << " threads";
  }
}

}  // namespace
}  // namespace kissmap
