// SPDX-License-Identifier: MIT
#include "simulator/town.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "simulator/random.hpp"
#include "simulator/town_block.hpp"

namespace kissmap::simulator {
namespace {

using Eigen::Vector3d;
constexpr std::uint64_t town_stream = 0x544F574E;

using Lane = std::pair<Crossing, Crossing>;  // driven from the first to the second

Vector3d right_of(const Vector3d& direction) {
  return {direction.y(), -direction.x(), 0.0};
}

std::vector<double> street_middles(const TownOptions& options, Random& random) {
  std::vector<double> middles{0.0};
  while (static_cast<int>(middles.size()) < options.streets) {
    middles.push_back(middles.back() + random.uniform(options.min_spacing, options.max_spacing));
  }
  return middles;
}

// Borders of the blocks along one axis: between the streets and beyond the outermost.
std::vector<std::pair<double, double>> block_spans(const std::vector<double>& middles,
                                                   double kerb,
                                                   double outskirts) {
  std::vector<std::pair<double, double>> spans{
      {middles.front() - kerb - outskirts, middles.front() - kerb}};
  for (std::size_t k = 1; k < middles.size(); ++k) {
    spans.emplace_back(middles[k - 1] + kerb, middles[k] - kerb);
  }
  spans.emplace_back(middles.back() + kerb, middles.back() + kerb + outskirts);
  return spans;
}

void add_blocks(Town& town, Random& random) {
  const TownOptions& options = town.options;
  const auto xs = block_spans(town.x_of_street, town.kerb_offset(), options.outskirts);
  const auto ys = block_spans(town.y_of_street, town.kerb_offset(), options.outskirts);
  for (std::size_t i = 0; i < xs.size(); ++i) {
    for (std::size_t j = 0; j < ys.size(); ++j) {
      Block block;
      block.low = {xs[i].first, ys[j].first};
      block.high = {xs[i].second, ys[j].second};
      block.sidewalk_width = options.sidewalk_width;
      block.parking_width = options.parking_width;
      // Spans are counted from the outskirts, blocks from the first street.
      const Crossing place{static_cast<int>(i) - 1, static_cast<int>(j) - 1};
      block.passages = place == courtyard_block;
      block.park = random.chance(options.park_share) && !block.passages;
      add_block(town.world, block, random);
    }
  }
}

void add_ground(Town& town) {
  const double margin = town.options.outskirts + 60.0;
  const Vector3d low(town.x_of_street.front() - margin, town.y_of_street.front() - margin, -1.0);
  const Vector3d high(town.x_of_street.back() + margin, town.y_of_street.back() + margin, 0.0);
  town.world.primitives.push_back(make_box(ObjectClass::ground, Rigid3{}, low, high));
}

// Roads and blocks as one grid of rectangles: along each axis, every second one is a block.
void add_floors(Town& town) {
  const TownOptions& options = town.options;
  const Eigen::AlignedBox3d ground = [&] {
    const Primitive& solid = town.world.primitives.front();
    const Vector3d& middle = solid.world_from_object.translation;
    return Eigen::AlignedBox3d(middle - solid.half_extents, middle + solid.half_extents);
  }();
  std::vector<double> cuts[2];
  for (const int axis : {0, 1}) {
    cuts[axis] = {ground.min()[axis]};
    for (const auto& [low, high] : block_spans(axis == 0 ? town.x_of_street : town.y_of_street,
                                               town.kerb_offset(),
                                               options.outskirts)) {
      cuts[axis].insert(cuts[axis].end(), {low, high});
    }
    cuts[axis].push_back(ground.max()[axis]);
  }
  for (std::size_t i = 0; i + 1 < cuts[0].size(); ++i) {
    for (std::size_t j = 0; j + 1 < cuts[1].size(); ++j) {
      const bool block = i % 2 == 1 && j % 2 == 1;
      town.world.floors.push_back({{Eigen::Vector2d(cuts[0][i], cuts[1][j]),
                                    Eigen::Vector2d(cuts[0][i + 1], cuts[1][j + 1])},
                                   block ? kerb_height : 0.0});
    }
  }
}

bool used_by_a_tour(const Lane& lane) {
  const auto uses = [&lane](const std::vector<Crossing>& route) {
    for (std::size_t k = 1; k < route.size(); ++k) {
      if (Lane(route[k - 1], route[k]) == lane) return true;
    }
    return false;
  };
  return uses(same_direction_route()) || uses(opposite_direction_route());
}

std::vector<Lane> free_lanes(int streets) {
  std::vector<Lane> lanes;
  for (int i = 0; i < streets; ++i) {
    for (int j = 0; j < streets; ++j) {
      for (const Crossing& next :
           {Crossing{i + 1, j}, Crossing{i - 1, j}, Crossing{i, j + 1}, Crossing{i, j - 1}}) {
        const bool inside = std::min(next.i, next.j) >= 0 && std::max(next.i, next.j) < streets;
        if (inside && !used_by_a_tour({{i, j}, next})) lanes.push_back({{i, j}, next});
      }
    }
  }
  return lanes;
}

MovingObject make_car(const Vector3d& start, const Vector3d& travel, Random& random) {
  const Rigid3 car = planar_frame(start, std::atan2(travel.y(), travel.x()));
  const double half = random.uniform(1.9, 2.5);
  MovingObject object;
  object.parts.push_back(
      make_box(ObjectClass::moving_car, car, {-half, -0.9, 0.25}, {half, 0.9, 0.85}));
  object.parts.push_back(make_box(ObjectClass::moving_car,
                                  car,
                                  {-half + 0.2, -0.8, 0.85},
                                  {0.3 * half, 0.8, random.uniform(1.4, 2.2)}));
  object.shuttle = {travel, travel.norm() / random.uniform(1.5, 2.6), random.uniform()};
  return object;
}

// One car at most on each lane; it stays clear of the crossings.
void add_moving_cars(Town& town, Random& random) {
  std::vector<Lane> lanes = free_lanes(town.options.streets);
  for (int k = 0; k < town.options.moving_cars && !lanes.empty(); ++k) {
    const auto pick =
        static_cast<std::ptrdiff_t>(random.uniform() * static_cast<double>(lanes.size()));
    const auto [from, to] = lanes[static_cast<std::size_t>(pick)];
    lanes.erase(lanes.begin() + pick);
    const Vector3d whole = town.middle(to) - town.middle(from);
    const Vector3d direction = whole.normalized();
    const Vector3d start =
        town.middle(from) + 14.0 * direction + town.lane_offset() * right_of(direction);
    town.world.moving.push_back(make_car(start, whole - 28.0 * direction, random));
  }
}

void add_pedestrians(Town& town, Random& random) {
  constexpr double from_kerb = 1.3;
  for (int k = 0; k < town.options.pedestrians; ++k) {
    const auto place = [&] {
      return static_cast<int>(random.uniform(0.0, town.options.streets - 1));
    };
    const bool along_x = random.chance(0.5);
    const Crossing from{place(), place()};
    const Crossing to = along_x ? Crossing{from.i + 1, from.j} : Crossing{from.i, from.j + 1};
    const Vector3d whole = town.middle(to) - town.middle(from);
    const Vector3d direction = whole.normalized();
    const double aside = random.sign() * (town.kerb_offset() + from_kerb);
    const double at = random.uniform(12.0, 0.5 * whole.norm());
    const Vector3d start = town.middle(from) + at * direction + aside * right_of(direction) +
                           Vector3d(0, 0, kerb_height);
    const double length = random.uniform(8.0, 0.5 * whole.norm() - 12.0);
    const double height = random.uniform(1.5, 1.9);
    MovingObject object;
    object.parts.push_back(make_cylinder(
        ObjectClass::pedestrian, planar_frame(start, 0), {0, 0, 0}, 0.22, height - 0.25));
    object.parts.push_back(make_cylinder(
        ObjectClass::pedestrian, planar_frame(start, 0), {0, 0, height - 0.25}, 0.1, 0.25));
    object.shuttle = {length * direction, length * random.uniform(2.0, 3.0), random.uniform()};
    town.world.moving.push_back(object);
  }
}

}  // namespace

Vector3d Town::middle(Crossing crossing) const {
  return {x_of_street.at(static_cast<std::size_t>(crossing.i)),
          y_of_street.at(static_cast<std::size_t>(crossing.j)),
          0.0};
}

std::vector<Vector3d> Town::lane_through(const std::vector<Crossing>& crossings) const {
  std::vector<Vector3d> way;
  for (std::size_t k = 0; k < crossings.size(); ++k) {
    const Vector3d here = middle(crossings[k]);
    const Vector3d in =
        k > 0 ? (here - middle(crossings[k - 1])).normalized() : Vector3d::Zero().eval();
    const Vector3d out = k + 1 < crossings.size() ? (middle(crossings[k + 1]) - here).normalized()
                                                  : Vector3d::Zero().eval();
    const bool straight = in.isApprox(out) || in.isZero() || out.isZero();
    const Vector3d aside =
        straight ? right_of(in.isZero() ? out : in) : Vector3d(right_of(in) + right_of(out));
    way.push_back(here + lane_offset() * aside);
  }
  return way;
}

std::vector<Crossing> same_direction_route() {
  return {{1, 1},
          {2, 1},
          {3, 1},
          {3, 2},
          {3, 3},
          {2, 3},
          {1, 3},
          {1, 2},
          {1, 1},
          {2, 1},
          {3, 1},
          {3, 2}};
}

std::vector<Crossing> opposite_direction_route() {
  return {{0, 0},
          {1, 0},
          {1, 1},
          {2, 1},
          {3, 1},
          {3, 2},
          {3, 3},
          {2, 3},
          {2, 2},
          {2, 1},
          {1, 1},
          {1, 0},
          {0, 0}};
}

int free_lane_count(const TownOptions& options) {
  return static_cast<int>(free_lanes(options.streets).size());
}

Town make_town(std::uint64_t seed, const TownOptions& options) {
  Random random{seed, town_stream};
  Town town;
  town.options = options;
  town.x_of_street = street_middles(options, random);
  town.y_of_street = street_middles(options, random);
  add_ground(town);
  add_floors(town);
  add_blocks(town, random);
  add_moving_cars(town, random);
  add_pedestrians(town, random);
  return town;
}

}  // namespace kissmap::simulator
