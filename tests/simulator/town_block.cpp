// SPDX-License-Identifier: MIT
#include "simulator/town_block.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "simulator/town.hpp"

namespace kissmap::simulator {
namespace {

using Eigen::Vector3d;
constexpr double pi = std::numbers::pi;
constexpr double max_depth = 16.5;        // m, of a house with its setback
constexpr double passage_half = 2.0;      // m
constexpr double corner_clearance = 7.0;  // m without furniture next to a crossing

// One side of a block: x along the kerb, y inwards, z up from the sidewalk; x = 0 at a corner.
struct Side {
  Rigid3 world_from_side;
  double length = 0.0;
};

// Numbers are drawn inside braces or one a statement: the order of function arguments is free.
class BlockBuilder {
 public:
  BlockBuilder(World& world, const Block& block, Random& random)
      : world_(world), block_(block), random_(random) {}

  void build() {
    const Eigen::Vector2d size = block_.high - block_.low;
    box(ObjectClass::sidewalk, block_frame(), {0, 0, -0.3}, {size.x(), size.y(), 0});
    const bool rows[4] = {true, false, true, false};  // southern and northern rows own the corners
    for (int k = 0; k < 4; ++k) {
      const Side side = side_of(k);
      if (block_.park) {
        add_park_edge(side);
      } else {
        add_row(side, rows[k]);
      }
      add_furniture(side);
      add_parked_cars(side);
    }
    plant_inside(block_.park ? 26 : 9);
  }

 private:
  Rigid3 block_frame() const {
    return planar_frame({block_.low.x(), block_.low.y(), kerb_height}, 0.0);
  }

  Side side_of(int k) const {
    const Eigen::Vector2d corners[4] = {block_.low,
                                        {block_.high.x(), block_.low.y()},
                                        block_.high,
                                        {block_.low.x(), block_.high.y()}};
    const Eigen::Vector2d from = corners[k];
    const double length = (corners[(k + 1) % 4] - from).norm();
    return {planar_frame({from.x(), from.y(), kerb_height}, k * pi / 2), length};
  }

  void box(ObjectClass what, const Rigid3& frame, const Vector3d& low, const Vector3d& high) {
    world_.primitives.push_back(make_box(what, frame, low, high));
  }
  void cylinder(
      ObjectClass what, const Rigid3& frame, const Vector3d& base, double radius, double height) {
    world_.primitives.push_back(make_cylinder(what, frame, base, radius, height));
  }

  // Houses along a side; a row that does not own the corners starts behind the crossing rows.
  void add_row(const Side& side, bool owns_corners) {
    const double inset = owns_corners ? block_.sidewalk_width : block_.sidewalk_width + max_depth;
    const double begin = inset;
    const double end = side.length - inset;
    if (!(block_.passages && owns_corners)) return add_houses(side, begin, end);
    add_houses(side, begin, 0.5 * side.length - passage_half);
    add_houses(side, 0.5 * side.length + passage_half, end);
  }

  void add_houses(const Side& side, double begin, double end) {
    double at = begin;
    while (end - at > 5.0) {
      double width = random_.uniform(9.0, 21.0);
      if (end - at - width < 8.0) width = end - at;
      if (random_.chance(0.16) && at > begin) {
        const double gap = std::min(random_.uniform(2.5, 6.0), end - at);
        if (random_.chance(0.6)) add_fence(side, at, at + gap);
        at += gap;
        width -= gap;
      }
      if (width > 5.0) add_house(side, at, at + width);
      at += std::max(width, 0.0);
    }
  }

  void add_fence(const Side& side, double from, double to) {
    const double y = block_.sidewalk_width + random_.uniform(0.0, 2.0);
    const double height = random_.uniform(0.9, 2.0);
    box(ObjectClass::fence, side.world_from_side, {from, y, 0}, {to, y + 0.1, height});
  }

  void add_house(const Side& side, double from, double to) {
    const double setback = random_.chance(0.45) ? 0.0 : random_.uniform(0.3, 2.6);
    const double front = block_.sidewalk_width + setback;
    const double back = front + random_.uniform(8.5, 13.0);
    const double height = random_.uniform(5.0, 17.0);
    const double middle = 0.5 * (from + to);
    // Hardly any house stands exactly along its street.
    const Rigid3 house =
        side.world_from_side * planar_frame({middle, front, 0}, 0.012 * random_.normal());
    const double half = 0.5 * (to - from);
    box(ObjectClass::building, house, {-half, 0, 0}, {half, back - front, height});
    add_front(house, half, height, setback);
    if (random_.chance(0.5)) add_roof(house, half, back - front, height);
    if (random_.chance(0.4)) {
      const double x = random_.uniform(-half + 2.0, half - 2.0);
      const double deep = back - front + random_.uniform(1.0, 3.0);
      box(ObjectClass::building,
          house,
          {x - 2.0, 0.2, 0},
          {x + 2.0, deep, random_.uniform(3.0, height)});
    }
    if (setback > 1.2 && random_.chance(0.5)) {
      box(ObjectClass::hedge, house, {-half, -setback + 0.1, 0}, {half - 2.5, -setback + 0.6, 0.9});
    }
  }

  // Bays, porches and balconies. At street level nothing reaches far into the sidewalk.
  void add_front(const Rigid3& house, double half, double height, double setback) {
    for (double x = -half + 0.4; x < half - 1.0;) {
      const double width = std::min(random_.uniform(0.4, 3.0), half - x);
      const bool low = random_.chance(0.5);
      const double reach =
          low ? std::min(random_.uniform(0.1, 1.0), setback + 0.25) : random_.uniform(0.2, 1.1);
      const double bottom = low ? 0.0 : random_.uniform(2.6, std::max(2.7, height - 1.5));
      const double top = low && random_.chance(0.5) ? random_.uniform(0.6, 3.2)
                                                    : bottom + random_.uniform(0.9, 3.5);
      box(ObjectClass::building,
          house,
          {x, -reach, bottom},
          {x + width, 0.1, std::min(top, height)});
      x += width + random_.uniform(0.5, 4.0);
    }
  }

  void add_roof(const Rigid3& house, double half, double depth, double height) {
    const double edge = random_.uniform(0.3, 2.0);
    const double top = height + random_.uniform(0.6, 3.0);
    box(ObjectClass::building,
        house,
        {-half + edge, edge, height},
        {half - edge, depth - edge, top});
  }

  void add_park_edge(const Side& side) {
    const double y = block_.sidewalk_width;
    for (double x = y; x < side.length - y - 4.0;) {
      const double length = std::min(random_.uniform(4.0, 14.0), side.length - y - x);
      const bool hedge = random_.chance(0.6);
      const double height = hedge ? random_.uniform(0.7, 1.8) : 1.1;
      box(hedge ? ObjectClass::hedge : ObjectClass::fence,
          side.world_from_side,
          {x, y, 0},
          {x + length, y + (hedge ? 0.7 : 0.08), height});
      x += length + random_.uniform(1.5, 7.0);
    }
  }

  void add_furniture(const Side& side) {
    for (double x = corner_clearance; x < side.length - corner_clearance;) {
      const double y = random_.uniform(0.4, 0.6);
      const double kind = random_.uniform();
      if (kind < 0.45) {
        add_tree(side.world_from_side, {x, y, 0}, random_.uniform(0.7, 1.1));
      } else if (kind < 0.8) {
        const double radius = random_.uniform(0.04, 0.1);
        cylinder(
            ObjectClass::pole, side.world_from_side, {x, y, 0}, radius, random_.uniform(2.5, 7.0));
      } else {
        box(ObjectClass::pole,
            side.world_from_side,
            {x - 0.3, y - 0.2, 0},
            {x + 0.3, y + 0.2, random_.uniform(0.8, 1.4)});
      }
      x += random_.uniform(4.0, 13.0);
    }
  }

  void add_tree(const Rigid3& frame, const Vector3d& foot, double scale) {
    const double crown_base = 2.4 + random_.uniform(0.0, 1.0);
    cylinder(ObjectClass::trunk, frame, foot, 0.18 * scale, crown_base + 0.5);
    const int lumps = 3 + static_cast<int>(random_.uniform(0.0, 3.0));
    for (int i = 0; i < lumps; ++i) {
      const double s = scale * random_.uniform(0.6, 1.1);
      const Vector3d middle = foot + Vector3d{scale * random_.uniform(-0.9, 0.9),
                                              scale * random_.uniform(-0.9, 0.9),
                                              crown_base + s + scale * random_.uniform(0.0, 2.5)};
      const Rigid3 lump = frame * planar_frame(middle, random_.uniform(0.0, pi / 2));
      const Vector3d half = s * Vector3d{random_.uniform(0.6, 1.2), random_.uniform(0.6, 1.2), 0.9};
      box(ObjectClass::crown, lump, -half, half);
    }
  }

  void add_parked_cars(const Side& side) {
    const double corner = corner_clearance + 1.0;
    for (double x = corner; x < side.length - corner - 5.0;) {
      const double length = random_.uniform(3.6, 5.0);
      if (random_.chance(0.5)) add_parked_car(side, x, length);
      x += length + random_.uniform(0.8, 2.5);
    }
  }

  void add_parked_car(const Side& side, double x, double length) {
    const double y = -0.5 * block_.parking_width + random_.uniform(-0.1, 0.1);
    const Rigid3 car = side.world_from_side *
                       planar_frame({x + 0.5 * length, y, -kerb_height}, 0.02 * random_.normal());
    simulator::add_parked_car(world_, car, length, random_);
  }

  // Trees, benches and sheds behind the houses, or in the park.
  void plant_inside(int count) {
    const Eigen::Vector2d size = block_.high - block_.low;
    const double margin = block_.park ? 5.0 : 18.0;
    for (int i = 0; i < count; ++i) {
      const Vector3d foot{random_.uniform(margin, size.x() - margin),
                          random_.uniform(margin, size.y() - margin),
                          0.0};
      const double scale = random_.uniform(0.8, 1.6);
      const double kind = random_.uniform();
      if (block_.passages && std::abs(foot.x() - 0.5 * size.x()) < 6.5) continue;
      if (kind < 0.7) {
        add_tree(block_frame(), foot, scale);
        continue;
      }
      const Rigid3 shed = block_frame() * planar_frame(foot, random_.uniform(0.0, pi));
      const Vector3d half{random_.uniform(0.4, 1.8), random_.uniform(0.3, 1.2), 0.0};
      box(ObjectClass::building, shed, -half, half + Vector3d(0, 0, random_.uniform(0.5, 2.6)));
    }
  }

  World& world_;
  const Block& block_;
  Random& random_;
};

}  // namespace

void add_block(World& world, const Block& block, Random& random) {
  BlockBuilder(world, block, random).build();
}

}  // namespace kissmap::simulator
