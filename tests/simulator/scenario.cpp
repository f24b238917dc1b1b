// SPDX-License-Identifier: MIT
#include "simulator/scenario.hpp"

#include "kissmap/error.hpp"
#include "simulator/tours.hpp"

namespace kissmap::simulator {
namespace {

Motion town_motion(const Town& town, const Scenario& scenario) {
  const std::string& motion = scenario.motion;
  if (motion == "car") return town_car_tour(town, scenario.seed, Revisit::same_direction);
  if (motion == "car-opposite")
    return town_car_tour(town, scenario.seed, Revisit::opposite_direction);
  if (motion == "handheld") return town_walk(town, scenario.seed, scenario.liveliness);
  if (motion == "robot") return town_robot_tour(town, scenario.seed);
  throw usage_error("unknown motion " + motion +
                    " in a town; choose car, car-opposite, handheld or robot");
}

Motion office_motion(const Office& office, const Scenario& scenario) {
  if (scenario.motion == "handheld") return office_walk(office, scenario.seed, scenario.liveliness);
  if (scenario.motion == "robot") return office_robot_tour(office, scenario.seed);
  throw usage_error("motion " + scenario.motion +
                    " does not fit an office; choose handheld or robot");
}

}  // namespace

Simulator make_simulator(const Scenario& scenario) {
  if (!(scenario.liveliness >= 0.0 && scenario.liveliness <= 1.0)) {
    throw usage_error("liveliness must be 0 to 1");
  }
  SensorModel sensor = sensor_by_name(scenario.sensor, scenario.columns);
  if (scenario.world == "town") {
    Town town = make_town(scenario.seed);
    Motion motion = town_motion(town, scenario);
    return {
        std::move(town.world), std::move(sensor), std::move(motion), scenario.seed, scenario.scans};
  }
  if (scenario.world == "office") {
    Office office = make_office(scenario.seed);
    Motion motion = office_motion(office, scenario);
    return {std::move(office.world),
            std::move(sensor),
            std::move(motion),
            scenario.seed,
            scenario.scans};
  }
  throw usage_error("unknown world " + scenario.world + "; choose town or office");
}

}  // namespace kissmap::simulator
