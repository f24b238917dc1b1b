// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>

#include "simulator/simulator.hpp"

namespace kissmap::simulator {

/// A log to simulate, in words: what the program takes from its command line.
struct Scenario {
  std::string world = "town";         ///< town or office
  std::string sensor = "spinning64";  ///< see sensor_by_name
  std::string motion = "car";         ///< car, car-opposite, handheld or robot
  std::uint64_t seed = 1;             ///< of the world, the motion and the noise
  std::size_t scans = 0;              ///< 0: the whole tour
  int columns = 0;                    ///< of a turn or a line; 0: as usual for the sensor
  double liveliness = 1.0;            ///< of a walk: 0 glides, 1 shakes and looks around
};

/// Throws Error(usage) for unknown words and for a car in the office.
Simulator make_simulator(const Scenario& scenario);

}  // namespace kissmap::simulator
