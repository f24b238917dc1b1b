// SPDX-License-Identifier: MIT
#include "simulator/scenario.hpp"

#include <algorithm>
#include <utility>

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

void require_car(const Scenario& scenario) {
  if (scenario.motion != "car") {
    throw usage_error("motion " + scenario.motion + " does not fit a " + scenario.world +
                      "; choose car");
  }
  if (scenario.movers) {
    throw usage_error("nothing moves in a " + scenario.world + "; movers are for town and office");
  }
}

struct Place {
  World world;
  Motion motion;
};

Place town_place(const Scenario& scenario) {
  TownOptions options;
  if (scenario.movers) {
    options.moving_cars = std::min(*scenario.movers / 5, free_lane_count(options));
    options.pedestrians = *scenario.movers - options.moving_cars;
  }
  Town town = make_town(scenario.seed, options);
  Motion motion = town_motion(town, scenario);
  return {std::move(town.world), std::move(motion)};
}

Place office_place(const Scenario& scenario) {
  OfficeOptions options;
  options.walkers = scenario.movers.value_or(options.walkers);
  Office office = make_office(scenario.seed, options);
  Motion motion = office_motion(office, scenario);
  return {std::move(office.world), std::move(motion)};
}

Place place(const Scenario& scenario) {
  if (scenario.world == "town") return town_place(scenario);
  if (scenario.world == "office") return office_place(scenario);
  if (scenario.world == "garage") {
    require_car(scenario);
    Garage garage = make_garage(scenario.seed);
    return {std::move(garage.world), garage_car_tour(garage, scenario.seed)};
  }
  if (scenario.world == "hill") {
    require_car(scenario);
    Hill hill = make_hill(scenario.seed);
    return {std::move(hill.world), hill_car_tour(hill, scenario.seed)};
  }
  throw usage_error("unknown world " + scenario.world + "; choose town, office, garage or hill");
}

}  // namespace

Simulator make_simulator(const Scenario& scenario) {
  if (!(scenario.liveliness >= 0.0 && scenario.liveliness <= 1.0)) {
    throw usage_error("liveliness must be 0 to 1");
  }
  if (scenario.movers.value_or(0) < 0) throw usage_error("the number of movers is negative");
  SensorModel sensor = sensor_by_name(scenario.sensor, scenario.columns);
  Place where = place(scenario);
  return {std::move(where.world),
          std::move(sensor),
          std::move(where.motion),
          scenario.seed,
          scenario.scans};
}

}  // namespace kissmap::simulator
