// SPDX-License-Identifier: MIT
#include "simulator/tours.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>
#include <vector>

#include "simulator/random.hpp"
#include "simulator/route.hpp"

namespace kissmap::simulator {
namespace {

using Eigen::Vector3d;
using Way = std::vector<Vector3d>;
constexpr double pi = std::numbers::pi;
constexpr double degree = pi / 180.0;
constexpr std::uint64_t tour_stream = 0x544F5552;

PoseVector amplitude(
    double x, double y, double z, double roll_deg, double pitch_deg, double yaw_deg) {
  PoseVector pose;
  pose << x, y, z, roll_deg * degree, pitch_deg * degree, yaw_deg * degree;
  return pose;
}

std::vector<Wobble> with_phases(std::vector<Wobble> wobbles, Random& random) {
  for (Wobble& wobble : wobbles) wobble.phase = random.uniform(0.0, 2.0 * pi);
  return wobbles;
}

std::vector<Wobble> suspension(Random& random) {
  return with_phases({{amplitude(0, 0, 0.012, 0.0, 0.12, 0), 1.31, 0},
                      {amplitude(0, 0, 0.008, 0.15, 0.0, 0), 1.07, 0},
                      {amplitude(0, 0, 0.002, 0.03, 0.03, 0), 2.9, 0},
                      {amplitude(0, 0.05, 0.0, 0.0, 0.0, 0.5), 0.13, 0}},
                     random);
}

std::vector<Wobble> steps(Random& random) {
  return with_phases({{amplitude(0.01, 0, 0.03, 0, 1.5, 0), 1.8, 0},
                      {amplitude(0, 0.025, 0, 2.0, 0, 2.0), 0.9, 0},
                      {amplitude(0, 0, 0, 4.0, 3.0, 0), 0.21, 0},
                      {amplitude(0, 0, 0.02, 0, 5.0, 5.0), 0.137, 0},
                      {amplitude(0.003, 0.003, 0.003, 0.4, 0.4, 0.4), 4.3, 0}},
                     random);
}

std::vector<Wobble> wheels(Random& random) {
  return with_phases({{amplitude(0, 0, 0.002, 0.1, 0.15, 0), 3.7, 0},
                      {amplitude(0, 0, 0.001, 0.15, 0.05, 0.1), 5.3, 0}},
                     random);
}

DrivingStyle car_style() {
  DrivingStyle style;
  style.pitch_by_acceleration = 0.008;
  style.roll_by_acceleration = 0.012;
  return style;
}

DrivingStyle walking_style() {
  DrivingStyle style;
  style.max_speed = 1.35;
  style.turn_rate = 40 * degree;
  style.acceleration = style.braking = 0.8;
  style.lateral_acceleration = 1.2;
  style.corner_radius = 0.7;
  style.corner_smoothing = 0.4;
  style.interval = 0.2;
  return style;
}

DrivingStyle robot_style(double max_speed) {
  DrivingStyle style;
  style.max_speed = max_speed;
  style.turn_rate = 50 * degree;
  style.acceleration = style.braking = 0.5;
  return style;
}

// 0 to 1 to 0: rising, staying and falling with the minimum-jerk blend.
double look_profile(double time, double rise, double stay) {
  const double u = std::clamp(std::min(time, 2 * rise + stay - time) / rise, 0.0, 1.0);
  return u * u * u * (10.0 - 15.0 * u + 6.0 * u * u);
}

// Turns the plan's heading aside every few seconds, as people look around.
void look_around(std::vector<PoseVector>& poses,
                 double interval,
                 double liveliness,
                 Random& random) {
  const double peak_rate = liveliness * 75 * degree;  // rad/s, of the look alone
  const double end = static_cast<double>(poses.size() - 1) * interval;
  for (double begin = random.uniform(2.0, 4.0);;) {
    const double yaw = random.sign() * random.uniform(35.0, 110.0) * degree;
    const double pitch = random.uniform(-18.0, 18.0) * degree;
    const double rise = 1.875 * std::abs(yaw) / peak_rate * random.uniform(1.0, 1.5);
    const double stay = random.uniform(0.2, 1.2);
    const double over = begin + 2 * rise + stay;
    if (over > end) return;
    for (auto i = static_cast<std::size_t>(begin / interval);
         static_cast<double>(i) * interval < over;
         ++i) {
      const double look = look_profile(static_cast<double>(i) * interval - begin, rise, stay);
      poses[i][4] += look * pitch;
      poses[i][5] += look * yaw;
    }
    begin = over + random.uniform(1.5, 5.0);
  }
}

Motion with_lidar_at(double height, const DrivingStyle& style, std::vector<PoseVector> poses) {
  Motion motion;
  motion.interval = style.interval;
  motion.control = std::move(poses);
  motion.body_from_lidar.translation.z() = height;
  return motion;
}

Motion walk(const Way& way, std::uint64_t seed, double liveliness) {
  Random random{seed, tour_stream, 1};
  const DrivingStyle style = walking_style();
  std::vector<PoseVector> poses = drive(way, style);
  if (liveliness > 0.0) look_around(poses, style.interval, liveliness, random);
  // Looks and sway turn about the hand, not about the feet.
  for (PoseVector& pose : poses) pose[2] += 1.4;
  Motion motion = with_lidar_at(0.1, style, std::move(poses));
  motion.wobbles = steps(random);
  for (Wobble& wobble : motion.wobbles) wobble.amplitude *= liveliness;
  return motion;
}

Motion roll(const Way& way, double max_speed, double height, std::uint64_t seed) {
  Random random{seed, tour_stream, 2};
  const DrivingStyle style = robot_style(max_speed);
  Motion motion = with_lidar_at(height, style, drive_with_turns_in_place(way, style));
  motion.wobbles = wheels(random);
  return motion;
}

Motion car_drive(const Way& way, const DrivingStyle& style, std::uint64_t seed) {
  Random random{seed, tour_stream, 0};
  Motion motion = with_lidar_at(1.9, style, drive(way, style));
  motion.wobbles = suspension(random);
  return motion;
}

// Westwards along the south side, up the western side, eastwards along the north side to its
// passage, through the courtyard, out in the south, and the first part again.
Way way_around_the_block(const Town& town) {
  const Crossing block = courtyard_block;
  const double aside = town.kerb_offset() + 2.25;
  const Vector3d low = town.middle(block) + Vector3d(aside, aside, kerb_height);
  const Vector3d high =
      town.middle({block.i + 1, block.j + 1}) + Vector3d(-aside, -aside, kerb_height);
  const Vector3d middle = 0.5 * (low + high);
  const auto at = [&](double x, double y) { return Vector3d(x, y, kerb_height); };
  return {at(middle.x() + 12.0, low.y()),
          at(low.x(), low.y()),
          at(low.x(), high.y()),
          at(middle.x(), high.y()),
          at(middle.x(), middle.y() + 8.0),
          at(middle.x() + 3.5, middle.y() + 2.0),
          at(middle.x() - 2.5, middle.y() - 4.0),
          at(middle.x(), middle.y() - 9.0),
          at(middle.x(), low.y()),
          at(low.x(), low.y()),
          at(low.x(), middle.y())};
}

struct Visit {
  double along;  // m, from the start of the corridor's side
  Vector3d at_corridor;
  Way inside;
};

// A small round through the free middle of a room, so that nobody has to turn on the heel.
Way round_in_room(const Vector3d& door, const Vector3d& in) {
  const Vector3d aside = 0.8 * Vector3d(in.y(), -in.x(), 0.0);
  return {door + 1.1 * in,
          door + 2.0 * in + aside,
          door + 2.9 * in,
          door + 2.0 * in - aside,
          door + 1.1 * in};
}

// Core rooms with open doors towards one straight part of the corridor's middle line, in its order.
// Only core rooms, because people walk on the other side of the corridor.
std::vector<Visit> visits_along(const Office& office, const Vector3d& from, const Vector3d& to) {
  const Vector3d direction = (to - from).normalized();
  std::vector<Visit> visits;
  for (const PlanRoom& room : office.rooms) {
    const Vector3d door(room.door.middle.x(), room.door.middle.y(), 0.0);
    const Vector3d in(room.door.into_room.x(), room.door.into_room.y(), 0.0);
    const double along = (door - from).dot(direction);
    const Vector3d foot = from + along * direction;
    const bool beside = (door - foot).norm() < office.options.corridor_width &&
                        office.core.contains((door + in).head<2>()) && along > 1.0 &&
                        along < (to - from).norm() - 1.0;
    if (room.door.open && beside) visits.push_back({along, foot, round_in_room(door, in)});
  }
  std::ranges::sort(visits, {}, &Visit::along);
  return visits;
}

// The middle line of the ring corridor, counter-clockwise, with every second open core room.
Way way_through_the_office(const Office& office) {
  const Eigen::Vector2d low = 0.5 * (office.ring.min() + office.core.min());
  const Eigen::Vector2d high = 0.5 * (office.ring.max() + office.core.max());
  const Vector3d corners[4] = {{low.x(), low.y(), 0},
                               {high.x(), low.y(), 0},
                               {high.x(), high.y(), 0},
                               {low.x(), high.y(), 0}};
  const Vector3d start = corners[0] + Vector3d(2.5, 0, 0);
  Way way{start};
  int open_rooms = 0;
  for (int k = 0; k < 4; ++k) {
    const Vector3d from = k == 0 ? start : corners[k];
    const Vector3d to = corners[(k + 1) % 4];
    for (const Visit& visit : visits_along(office, from, to)) {
      if (open_rooms++ % 2 != 0) continue;
      way.push_back(visit.at_corridor);
      way.insert(way.end(), visit.inside.begin(), visit.inside.end());
      way.push_back(visit.at_corridor);
    }
    way.push_back(to);
  }
  way.push_back(corners[0] + Vector3d(14.0, 0, 0));
  return way;
}

}  // namespace

Motion town_car_tour(const Town& town, std::uint64_t seed, Revisit revisit) {
  return town_car_drive(
      town,
      seed,
      revisit == Revisit::same_direction ? same_direction_route() : opposite_direction_route());
}

Motion town_car_drive(const Town& town, std::uint64_t seed, const std::vector<Crossing>& route) {
  return car_drive(town.lane_through(route), car_style(), seed);
}

Motion garage_car_tour(const Garage& garage, std::uint64_t seed) {
  DrivingStyle style = car_style();
  style.max_speed = 4.0;
  style.corner_radius = 4.5;
  style.corner_smoothing = 2.0;
  return car_drive(garage.way, style, seed);
}

Motion hill_car_tour(const Hill& hill, std::uint64_t seed) {
  return car_drive(hill.way, car_style(), seed);
}

Motion town_walk(const Town& town, std::uint64_t seed, double liveliness) {
  return walk(way_around_the_block(town), seed, liveliness);
}

Motion town_robot_tour(const Town& town, std::uint64_t seed) {
  return roll(way_around_the_block(town), 1.2, 0.6, seed);
}

Motion office_robot_tour(const Office& office, std::uint64_t seed) {
  return roll(way_through_the_office(office), 0.9, 0.45, seed);
}

Motion office_walk(const Office& office, std::uint64_t seed, double liveliness) {
  return walk(way_through_the_office(office), seed, liveliness);
}

}  // namespace kissmap::simulator
