// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>

#include "simulator/simulator.hpp"

namespace kissmap::simulator {

/// A log to simulate, in words: what the program takes from its command line.
struct Scenario {
  std::string world = "town";         ///< town, office, garage or hill
  std::string sensor = "spinning64";  ///< see sensor_by_name
  std::string motion = "car";         ///< car, car-opposite, handheld or robot
  std::uint64_t seed = 1;             ///< of the world, the motion and the noise
  std::size_t scans = 0;              ///< 0: the whole tour
  int columns = 0;                    ///< of a turn or a line; 0: as usual for the sensor
  double liveliness = 1.0;            ///< of a walk: 0 glides, 1 shakes and looks around
  std::optional<int> movers{};        ///< people and cars on the move in town or office
};

/// A fifth of a town's movers are cars as long as there are lanes that no tour uses. None stands
/// still for more than some seconds.
/// Throws Error(usage) for unknown words, for a car in the office, for anything but a car in a
/// garage or on a hill, and for movers where nothing moves.
Simulator make_simulator(const Scenario& scenario);

}  // namespace kissmap::simulator
