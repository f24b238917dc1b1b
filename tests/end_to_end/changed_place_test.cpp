// SPDX-License-Identifier: MIT
// A street driven again when it is not as it was: on the other lane, with the LiDAR higher, past
// other parked cars. One seed; KISSMAP_SEEDS=n for more.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "end_to_end/loop_expectations.hpp"
#include "simulator/scenario.hpp"
#include "simulator/tours.hpp"

namespace kissmap {
namespace {

using namespace simulator;

struct Change {
  const char* name = "";
  double to_the_left = 0.0;  ///< m
  double up = 0.0;           ///< m
  bool other_cars = false;   ///< every parked car has gone, others stand elsewhere
};

/// The control pose at which the tour comes back to its start.
std::size_t return_to_start(const Motion& motion) {
  const auto far = static_cast<std::size_t>(60.0 / motion.interval);
  for (std::size_t i = far; i < motion.control.size(); ++i) {
    if ((motion.control[i] - motion.control[0]).head<2>().norm() < 15.0) return i;
  }
  throw std::logic_error("the tour never comes back");
}

/// Moves over within 5 s once the tour is back at its start.
Motion changed(Motion motion, const Change& change, std::size_t from) {
  const double poses_to_move_over = 5.0 / motion.interval;
  for (std::size_t i = from; i < motion.control.size(); ++i) {
    const double share = std::min(1.0, static_cast<double>(i - from) / poses_to_move_over);
    const double blend = share * share * (3.0 - 2.0 * share);
    PoseVector& pose = motion.control[i];
    pose[0] -= blend * change.to_the_left * std::sin(pose[5]);
    pose[1] += blend * change.to_the_left * std::cos(pose[5]);
    pose[2] += blend * change.up;
  }
  return motion;
}

/// The world with every second of its parked cars, which are two boxes each.
World with_half_the_cars(World world, std::size_t which) {
  std::size_t boxes = 0;
  std::erase_if(world.primitives, [&](const Primitive& primitive) {
    return primitive.object_class == ObjectClass::parked_car && boxes++ / 2 % 2 != which;
  });
  return world;
}

class ChangedPlaces : public testing::TestWithParam<Change> {};

TEST_P(ChangedPlaces, AreFound) {
  const Change change = GetParam();
  for (std::uint64_t seed = 1; seed <= seeds(); ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    const Town town = make_town(seed);
    const Motion planned = town_car_tour(town, seed);
    const std::size_t back = return_to_start(planned);
    const Motion motion = changed(planned, change, back);
    const SensorModel sensor = sensor_by_name("spinning16", seeds() > 1 ? 0 : 600);
    const Simulator before(with_half_the_cars(town.world, 0), sensor, motion, seed);
    const Simulator after(
        with_half_the_cars(town.world, change.other_cars ? 1 : 0), sensor, motion, seed);
    const auto scan_back =
        static_cast<std::size_t>(static_cast<double>(back) * motion.interval / sensor.period);
    LoopTour tour;
    for (std::size_t i = 0; i < before.scan_count(); ++i) {
      tour.add((i < scan_back ? before : after).scan(i), before);
    }
    tour.finish();
    expect_true_closures(tour, 1.0);
    const std::vector<std::uint32_t> revisits = tour.revisits();
    EXPECT_GE(revisits.size(), 3U);
    expect_most_found(tour, revisits);
    EXPECT_LT(tour.ate(tour.correction()), std::max(0.15, tour.odometry_ate() / 3.0));
  }
}

INSTANTIATE_TEST_SUITE_P(Street,
                         ChangedPlaces,
                         testing::Values(Change{"other_lane", 3.2, 0.0, false},
                                         Change{"higher", 0.0, 0.8, false},
                                         Change{"other_cars", 0.0, 0.0, true}),
                         [](const auto& change) { return change.param.name; });

}  // namespace
}  // namespace kissmap
