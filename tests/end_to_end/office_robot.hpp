// SPDX-License-Identifier: MIT
#pragma once

#include "simulator/office.hpp"
#include "simulator/tours.hpp"
#include "support/laser_robot.hpp"
#include "support/monte_carlo_localiser.hpp"

namespace kissmap {

/// What a laser robot makes of a plan, from several places.
struct Localised {
  int converged = 0;
  double rms = 0.0;  ///< m, over the last quarter of the drives that converged
};

/// A robot with a planar laser, 0.15 m above the floor, that is to find itself in the first
/// simulated office.
class LaserRobotInTheOffice {
 public:
  /// The office as a perfect map shows it between two heights [m].
  OccupancyPlan exact_plan(double z_min, double z_max) const;

  /// The plan may lie elsewhere: `world_from_plan` tells where. `drives`: up to ten.
  Localised localise(const OccupancyPlan& plan,
                     const Pose2& world_from_plan = {},
                     std::uint64_t drives = 10) const;

  const simulator::Office& office() const { return office_; }
  std::vector<LaserStep> drive(const LaserRobotOptions& robot) const {
    return drive_laser_robot(caster_, motion_, robot);
  }

 private:
  /// Errors [m] of a drive of 60 m; none if it ends 0.2 m or 10 degrees off.
  std::vector<double> errors_of_drive(const OccupancyPlan& plan,
                                      const Pose2& world_from_plan,
                                      std::uint64_t seed) const;

  simulator::Office office_ = simulator::make_office(1);
  simulator::RayCaster caster_{office_.world};
  simulator::Motion motion_ = simulator::office_robot_tour(office_, 1);
};

}  // namespace kissmap
