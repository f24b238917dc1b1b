// SPDX-License-Identifier: MIT
// Deskewing against the simulator, which knows where the sensor was at each shot.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "kissmap/odometry/preprocess.hpp"
#include "simulator/scenario.hpp"
#include "simulator/simulator.hpp"

namespace kissmap::simulator {
namespace {

/// Largest distance between a deskewed point, taken to the map by the pose at the sweep's end, and
/// where the beam really hit. Points within 60 m.
struct Misplaced {
  double deskewed = 0.0;
  double as_recorded = 0.0;
};

Misplaced misplaced_points(const Simulator& simulator, std::size_t scan_idx) {
  const Scan scan = simulator.scan(scan_idx);
  const TimeSpan span = *time_span(scan);
  const auto pose_at = [&](float offset) {
    return simulator.map_from_lidar(scan.stamp_ns +
                                    std::llround(1e9 * static_cast<double>(offset)));
  };
  const Rigid3 map_from_end = pose_at(span.last);
  const auto motion = sweep_motion(scan, pose_at(span.first).inverse() * map_from_end);
  Misplaced worst;
  for (std::size_t i = 0; i < scan.points.size(); ++i) {
    if (scan.points[i].norm() > 60.0F) continue;
    const Eigen::Vector3d hit = pose_at(scan.time_offsets[i]) * scan.points[i].cast<double>();
    const auto error = [&](const Eigen::Vector3f& p) {
      return (map_from_end * p.cast<double>() - hit).norm();
    };
    worst.as_recorded = std::max(worst.as_recorded, error(scan.points[i]));
    worst.deskewed =
        std::max(worst.deskewed, error(motion->to_sweep_end(scan.points[i], scan.time_offsets[i])));
  }
  return worst;
}

TEST(DeskewAgainstSimulator, ExactForASensorAtConstantVelocity) {
  Motion straight;
  for (int i = 0; i < 60; ++i) {
    PoseVector pose = PoseVector::Zero();
    pose.head<3>() << 1.5 * i, 0.2 * i, 1.8;  // 15 m/s
    straight.control.push_back(pose);
  }
  World world;
  world.primitives.push_back(
      make_box(ObjectClass::ground, Rigid3{}, {-200, -200, -1}, {300, 200, 0}));
  world.primitives.push_back(
      make_box(ObjectClass::building, Rigid3{}, {-200, 20, 0}, {300, 30, 20}));
  const Simulator simulator(std::move(world), spinning_sensor(32, 500), straight, 1, 20);
  const Misplaced worst = misplaced_points(simulator, 10);
  EXPECT_GT(worst.as_recorded, 1.4);
  // 1e-4 m: floats at 60 m have steps of 4e-6 m, stamps of 1 ns.
  EXPECT_LT(worst.deskewed, 1e-4);
}

TEST(DeskewAgainstSimulator, LeavesOnlyTheAccelerationOfACar) {
  const Simulator simulator = make_simulator({"town", "spinning16", "car", 1, 300, 0, 1.0});
  for (std::size_t i = 20; i < 300; i += 40) {
    const Misplaced worst = misplaced_points(simulator, i);
    // In 0.1 s, 2 m/s^2 leave 2.5 mm; turning in at 0.7 rad/s in a second leaves 0.9 mrad, 5 cm at
    // 60 m.
    EXPECT_LT(worst.deskewed, 0.06) << "scan " << i;
    EXPECT_LT(worst.deskewed, 0.2 * worst.as_recorded) << "scan " << i;
  }
}

}  // namespace
}  // namespace kissmap::simulator
