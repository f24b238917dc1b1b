// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include <utility>

#include "clients/mrpt_client.hpp"
#include "kissmap/error.hpp"
#include "simulator/tours.hpp"
#include "support/plan_files.hpp"
#include "support/temp_dir.hpp"

namespace kissmap {
namespace {

using Eigen::Vector2d;

class Mrpt : public testing::Test {
 protected:
  // The land north of the storey keeps a flipped plan from falling on itself: corridors and outer
  // walls lie symmetrically, and a bounded start does not tell one side's doors from the other's.
  OccupancyPlan exact() const {
    const simulator::PlanFrame frame{{-1.0, -1.0}, 0.05, 840, 600};
    const simulator::FloorBand band{robot_.height - 0.02, robot_.height + 0.02};
    const Eigen::AlignedBox2d storey(Vector2d::Zero(),
                                     Vector2d(office_.options.length, office_.options.width));
    return exact_plan(solids_in_band(office_.world, frame, band),
                      [&](const Vector2d& p) { return storey.contains(p); });
  }

  // Start within 4 x 4 m.
  double median_error(const OccupancyPlan& plan, const ErrorBounds& bounds) const {
    const auto steps = drive_laser_robot(caster_, simulator::office_robot_tour(office_, 1), robot_);
    const Pose2& begin = steps.front().world_from_robot;
    const Vector2d place(begin.x, begin.y);
    const Eigen::AlignedBox2d start(place - Vector2d(1.5, 2.5), place + Vector2d(2.5, 1.5));
    const std::filesystem::path yaml = write_plan(plan, folder_.path());
    const double error = median_error_with_mrpt(yaml, steps, robot_, start, folder_.path(), bounds);
    RecordProperty("median_error_mm", static_cast<int>(1000.0 * error));
    return error;
  }

  TempDir folder_;
  simulator::Office office_ = simulator::make_office(1);
  simulator::RayCaster caster_{office_.world};
  LaserRobotOptions robot_;
};

TEST_F(Mrpt, LocalisesARobotOnTheExactPlan) {
  EXPECT_LT(median_error(exact(), {0.0, 0.1}), 0.1);
}

// A map whose origin is a metre off puts the robot a metre off.
TEST_F(Mrpt, IsOffWhereTheMapIsOff) {
  OccupancyPlan plan = exact();
  plan.origin.y() += 1.0;
  EXPECT_NEAR(median_error(plan, {0.85, 1.15}), 1.0, 0.15);
}

TEST_F(Mrpt, IsLostOnAFlippedPlan) {
  OccupancyPlan plan = exact();
  for (int row = 0; row < plan.height / 2; ++row) {
    for (int column = 0; column < plan.width; ++column) {
      std::swap(plan.cells[plan.index(column, row)],
                plan.cells[plan.index(column, plan.height - 1 - row)]);
    }
  }
  constexpr double anything = 1e9;
  EXPECT_GT(median_error(plan, {0.0, anything}), 0.5);  // the first attempt
}

TEST_F(Mrpt, FailuresOfItsProgramsAreTold) {
  LaserStep step;
  step.ranges.assign(360, 1.0F);
  EXPECT_THROW(localise_with_mrpt(folder_.path() / "no.yaml",
                                  {step, step, step},
                                  robot_,
                                  Eigen::AlignedBox2d(Vector2d::Zero(), Vector2d::Ones()),
                                  folder_.path()),
               Error);
}

}  // namespace
}  // namespace kissmap
