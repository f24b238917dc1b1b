// SPDX-License-Identifier: MIT
#include "simulator/garage.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "kissmap/error.hpp"
#include "simulator/random.hpp"

namespace kissmap::simulator {
namespace {

using Eigen::AlignedBox2d;
using Eigen::Vector2d;
using Eigen::Vector3d;
constexpr double pi = std::numbers::pi;
constexpr std::uint64_t garage_stream = 0x47415241;
constexpr double outer_wall = 0.3;   // m
constexpr double ramp_wall = 0.2;    // m
constexpr double parapet = 1.0;      // m
constexpr double pillar_half = 0.2;  // m
constexpr double bay_width = 2.5;    // m

class GarageBuilder {
 public:
  GarageBuilder(std::uint64_t seed, const GarageOptions& options)
      : o_(options), random_{seed, garage_stream} {
    garage_.options = options;
    const double run = o_.storey / std::tan(o_.ramp_slope);
    const Vector2d middle(0.5 * o_.length, 0.5 * o_.width);
    const Vector2d half(0.5 * run, o_.ramp_width);
    ramps_ = {middle - half, middle + half};
    const double ring = o_.bay + o_.aisle;
    const Vector2d core = 2.0 * (middle - Vector2d::Constant(ring));
    // 9 m before and behind the ramps are for turning into them.
    if (!(core.x() > run + 18.0 && core.y() > 2.0 * o_.ramp_width + 2.0)) {
      throw usage_error("garage: the ramps do not fit between the aisles");
    }
  }

  Garage build() {
    add_shell();
    for (const int level : {0, 1}) add_level(level);
    add_ramps();
    add_way();
    return std::move(garage_);
  }

 private:
  void box(ObjectClass what, const Vector3d& low, const Vector3d& high) {
    garage_.world.primitives.push_back(make_box(what, Rigid3{}, low, high));
  }

  void add_shell() {
    const double top = 2.0 * o_.storey;
    const double t = outer_wall;
    box(ObjectClass::wall, {-t, -t, -o_.slab}, {o_.length + t, 0, top});
    box(ObjectClass::wall, {-t, o_.width, -o_.slab}, {o_.length + t, o_.width + t, top});
    box(ObjectClass::wall, {-t, -t, -o_.slab}, {0, o_.width + t, top});
    box(ObjectClass::wall, {o_.length, -t, -o_.slab}, {o_.length + t, o_.width + t, top});
    box(ObjectClass::ceiling, {-t, -t, top - o_.slab}, {o_.length + t, o_.width + t, top});
  }

  // The slab leaves the ramps' place open; below them, the ground is theirs, too. The outer walls
  // stand on it.
  void add_level(int level) {
    const double x[4] = {-outer_wall, ramps_.min().x(), ramps_.max().x(), o_.length + outer_wall};
    const double y[4] = {-outer_wall, ramps_.min().y(), ramps_.max().y(), o_.width + outer_wall};
    for (int i = 0; i < 3; ++i) {
      for (int j = 0; j < 3; ++j) {
        if (i == 1 && j == 1) continue;
        FloorPiece piece;
        piece.area = {Vector2d(x[i], y[j]), Vector2d(x[i + 1], y[j + 1])};
        piece.height = level * o_.storey;
        piece.lowest_level = piece.highest_level = level;
        add_floor(garage_.world, ObjectClass::floor, piece, o_.slab);
      }
    }
    add_pillars(level);
    add_cars(level);
  }

  // Along the aisle: between bays and on the side of the core.
  void add_pillars(int level) {
    const double base = level * o_.storey;
    const double top = base + o_.storey - o_.slab;
    const double outside = o_.bay - 0.1;
    const double inside = o_.bay + o_.aisle + 0.4;
    for (double x = 3.0 * bay_width; x < o_.length - bay_width; x += 3.0 * bay_width) {
      for (const double y : {outside, o_.width - outside, inside, o_.width - inside}) {
        const bool in_cross_aisle = std::min(x, o_.length - x) < inside - 0.1;
        if (in_cross_aisle && y != outside && y != o_.width - outside) continue;
        box(ObjectClass::pillar,
            {x - pillar_half, y - pillar_half, base},
            {x + pillar_half, y + pillar_half, top});
      }
    }
  }

  void add_cars(int level) {
    const double base = level * o_.storey;
    for (double x = o_.bay + 0.5 * bay_width; x < o_.length - o_.bay; x += bay_width) {
      add_car({x, 0.5 * o_.bay, base}, 0.5 * pi);
      add_car({x, o_.width - 0.5 * o_.bay, base}, -0.5 * pi);
    }
    for (double y = o_.bay + 0.5 * bay_width; y < o_.width - o_.bay; y += bay_width) {
      add_car({0.5 * o_.bay, y, base}, 0.0);
      add_car({o_.length - 0.5 * o_.bay, y, base}, pi);
    }
  }

  void add_car(const Vector3d& bay, double yaw) {
    const bool taken = random_.chance(o_.taken_share);
    const double length = random_.uniform(3.7, 4.5);
    const double turn = random_.chance(0.5) ? pi : 0.0;
    // Hardly any car stands exactly in the middle of its bay. Two pillars reach 10 cm into bays.
    const Vector3d place =
        bay + Vector3d{random_.uniform(-0.1, 0.1), random_.uniform(-0.1, 0.1), 0};
    const Rigid3 frame = planar_frame(place, yaw + turn + 0.02 * random_.normal());
    if (taken) add_parked_car(garage_.world, frame, length, random_);
  }

  void add_ramps() {
    const double slope = std::tan(o_.ramp_slope);
    const double middle = 0.5 * o_.width;
    for (const bool up : {true, false}) {
      FloorPiece ramp;
      ramp.area = ramps_;
      (up ? ramp.area.min() : ramp.area.max()).y() = middle;
      ramp.height = up ? 0.0 : o_.storey;
      ramp.slope = {up ? slope : -slope, 0.0};
      ramp.highest_level = 1;
      add_floor(garage_.world, ObjectClass::floor, ramp, o_.storey + o_.slab);
      add_ramp_ends(ramp.area, up);
    }
    const double half = 0.5 * ramp_wall;
    for (const double y : {ramps_.min().y(), middle, ramps_.max().y()}) {
      box(ObjectClass::wall,
          {ramps_.min().x(), y - half, -o_.slab},
          {ramps_.max().x(), y + half, o_.storey + parapet});
    }
  }

  // A wall below the upper end and a parapet above the lower end.
  void add_ramp_ends(const AlignedBox2d& area, bool up) {
    const double below = up ? area.max().x() : area.min().x() - ramp_wall;
    const double above = up ? area.min().x() - ramp_wall : area.max().x();
    box(ObjectClass::wall,
        {below, area.min().y(), 0.0},
        {below + ramp_wall, area.max().y(), o_.storey - o_.slab});
    box(ObjectClass::wall,
        {above, area.min().y(), o_.storey},
        {above + ramp_wall, area.max().y(), o_.storey + parapet});
  }

  void add_way() {
    const double aside = o_.bay + 0.5 * o_.aisle;
    const Vector2d low(aside, aside);
    const Vector2d high(o_.length - aside, o_.width - aside);
    const double up = 0.5 * (o_.width + o_.ramp_width);
    const double down = 0.5 * (o_.width - o_.ramp_width);
    const double foot = ramps_.min().x();
    const double head = ramps_.max().x();
    const double z = o_.storey;
    garage_.way = {{low.x() + 6.0, low.y(), 0},
                   {high.x(), low.y(), 0},
                   {high.x(), high.y(), 0},
                   {low.x(), high.y(), 0},
                   {low.x(), up, 0},
                   {foot, up, 0},
                   {head, up, z},
                   {high.x(), up, z},
                   {high.x(), high.y(), z},
                   {low.x(), high.y(), z},
                   {low.x(), low.y(), z},
                   {high.x(), low.y(), z},
                   {high.x(), high.y(), z},
                   {low.x(), high.y(), z},
                   {low.x(), down, z},
                   {foot, down, z},
                   {head, down, 0},
                   {high.x(), down, 0},
                   {high.x(), high.y(), 0},
                   {low.x(), high.y(), 0},
                   {low.x(), low.y(), 0},
                   {low.x() + 16.0, low.y(), 0}};
  }

  GarageOptions o_;
  Garage garage_;
  Random random_;
  AlignedBox2d ramps_;
};

}  // namespace

Garage make_garage(std::uint64_t seed, const GarageOptions& options) {
  return GarageBuilder(seed, options).build();
}

}  // namespace kissmap::simulator
