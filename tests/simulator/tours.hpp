// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <vector>

#include "simulator/garage.hpp"
#include "simulator/hill.hpp"
#include "simulator/motion.hpp"
#include "simulator/office.hpp"
#include "simulator/town.hpp"

namespace kissmap::simulator {

/// How the car tour meets its beginning again.
enum class Revisit { same_direction, opposite_direction };

/// A car drives a loop through town and the first part of it again. LiDAR 1.9 m above the road.
/// At most 10 m/s and 0.7 rad/s; it nods when braking, leans in corners, and heaves.
Motion town_car_tour(const Town& town,
                     std::uint64_t seed,
                     Revisit revisit = Revisit::same_direction);

/// The same car on a way of your choice.
Motion town_car_drive(const Town& town, std::uint64_t seed, const std::vector<Crossing>& route);

/// The same car, at most 4 m/s, on the way of the garage: round both levels, up and down.
Motion garage_car_tour(const Garage& garage, std::uint64_t seed);

/// The same car once and a half round the hill.
Motion hill_car_tour(const Hill& hill, std::uint64_t seed);

/// Someone walks around a block, through its courtyard, and on over the first part again, LiDAR in
/// hand at 1.5 m: the bounce of steps, sway, and turns of about 100 deg/s when looking aside.
/// `liveliness` scales shaking and the speed of looks; 0 glides along without looking aside.
Motion town_walk(const Town& town, std::uint64_t seed, double liveliness = 1.0);

/// The way of town_walk by a small robot: at most 1.2 m/s, turning in place, LiDAR at 0.6 m.
Motion town_robot_tour(const Town& town, std::uint64_t seed);

/// A small robot goes around the corridor and into some rooms, turning in place, and beyond its
/// start. At most 0.9 m/s and 50 deg/s; LiDAR at 0.45 m.
Motion office_robot_tour(const Office& office, std::uint64_t seed);

/// The way of office_robot_tour on foot, LiDAR in hand.
Motion office_walk(const Office& office, std::uint64_t seed, double liveliness = 1.0);

}  // namespace kissmap::simulator
