// SPDX-License-Identifier: MIT
#include "simulator/hill.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "simulator/random.hpp"
#include "simulator/town.hpp"

namespace kissmap::simulator {
namespace {

using Eigen::AlignedBox2d;
using Eigen::Vector2d;
using Eigen::Vector3d;
constexpr double pi = std::numbers::pi;
constexpr std::uint64_t hill_stream = 0x48494C4C;
constexpr double kerb = 5.2;      // m from the middle of the road
constexpr double lane = 1.6;      // m from the middle of the road
constexpr double sidewalk = 3.2;  // m
constexpr double margin = 60.0;   // m of land around the streets
constexpr double corner_clearance = 8.0;

// A straight part of a profile from `begin` [m] on.
struct Part {
  double begin;
  double degrees;
};
// Flat within 12 m of the streets across, so that no street leans sideways.
constexpr Part along_x[] = {{-margin, 0},
                            {12, 2.5},
                            {16, 5},
                            {20, 7.5},
                            {48, 5},
                            {52, 2.5},
                            {56, 0},
                            {66, -2.5},
                            {70, -5},
                            {74, -7.5},
                            {96, -5},
                            {100, -2.5},
                            {106, 0}};
constexpr Part along_y[] = {{-margin, 0}, {12, 1.4}, {18, 2.75}, {62, 1.4}, {68, 0}};

template <std::size_t n>
double slope_at(const Part (&profile)[n], double place) {
  double degrees = 0.0;
  for (const Part& part : profile) {
    if (part.begin <= place) degrees = part.degrees;
  }
  return std::tan(degrees * pi / 180.0);
}

template <std::size_t n>
double height_at(const Part (&profile)[n], double place) {
  double height = 0.0;
  for (std::size_t k = 0; k < n; ++k) {
    const double end = k + 1 < n ? profile[k + 1].begin : place;
    const double length = std::min(end, place) - profile[k].begin;
    if (length > 0.0) height += length * std::tan(profile[k].degrees * pi / 180.0);
  }
  return height;
}

double road_height(const Vector2d& place) {
  return height_at(along_x, place.x()) + height_at(along_y, place.y());
}

template <std::size_t n>
std::vector<double> cuts(const Part (&profile)[n], double size) {
  std::vector<double> cuts{-kerb, kerb, size - kerb, size + kerb, size + margin};
  for (const Part& part : profile) cuts.push_back(part.begin);
  std::ranges::sort(cuts);
  return cuts;
}

// One side of a street: x along its kerb, y away from the road.
struct Side {
  Vector2d origin;
  Vector2d along;
  Vector2d outwards;
  double length;
  bool outer;

  Vector2d at(double x, double y) const { return origin + x * along + y * outwards; }
};

class HillBuilder {
 public:
  explicit HillBuilder(std::uint64_t seed) : random_{seed, hill_stream} {}

  Hill build() {
    add_ground();
    const Vector2d corners[4] = {
        {0, 0}, {hill_.length, 0}, {hill_.length, hill_.width}, {0, hill_.width}};
    for (int k = 0; k < 4; ++k) {
      const Vector2d along = (corners[(k + 1) % 4] - corners[k]).normalized();
      const Vector2d left(-along.y(), along.x());
      const double length = (corners[(k + 1) % 4] - corners[k]).norm();
      add_side({corners[k] + kerb * (left + along), along, left, length - 2.0 * kerb, false});
      add_side({corners[k] - kerb * (left + along), along, -left, length + 2.0 * kerb, true});
    }
    add_way();
    return std::move(hill_);
  }

 private:
  bool on_road(const Vector2d& p) const {
    const bool inside =
        p.x() > kerb && p.x() < hill_.length - kerb && p.y() > kerb && p.y() < hill_.width - kerb;
    const bool outside =
        p.x() < -kerb || p.x() > hill_.length + kerb || p.y() < -kerb || p.y() > hill_.width + kerb;
    return !inside && !outside;
  }

  double ground(const Vector2d& p) const {
    return road_height(p) + (on_road(p) ? 0.0 : kerb_height);
  }

  void add_ground() {
    const std::vector<double> xs = cuts(along_x, hill_.length);
    const std::vector<double> ys = cuts(along_y, hill_.width);
    for (std::size_t i = 0; i + 1 < xs.size(); ++i) {
      for (std::size_t j = 0; j + 1 < ys.size(); ++j) {
        FloorPiece piece;
        piece.area = {Vector2d(xs[i], ys[j]), Vector2d(xs[i + 1], ys[j + 1])};
        const Vector2d middle = piece.area.center();
        const bool road = on_road(middle);
        piece.height = road_height(piece.area.min()) + (road ? 0.0 : kerb_height);
        piece.slope = {slope_at(along_x, middle.x()), slope_at(along_y, middle.y())};
        add_floor(hill_.world, road ? ObjectClass::ground : ObjectClass::sidewalk, piece, 2.0);
      }
    }
  }

  void add_side(const Side& side) {
    const double reach = side.outer ? 14.0 : -sidewalk;  // outer rows close the corners
    for (double x = -reach; side.length + reach - x > 6.0;) {
      double width = random_.uniform(8.0, 16.0);
      if (side.length + reach - x - width < 6.0) width = side.length + reach - x;
      const bool gap = random_.chance(0.15);
      if (!gap) add_house(side, x, x + width);
      x += gap ? 0.5 * width : width;
    }
    for (double x = corner_clearance; x < side.length - corner_clearance;) {
      add_furniture(side.at(x, random_.uniform(0.4, 0.6)));
      x += random_.uniform(5.0, 14.0);
    }
    for (double x = corner_clearance + 4.0; x < side.length - corner_clearance - 8.0;) {
      const double length = random_.uniform(3.7, 4.9);
      if (random_.chance(0.5)) add_car(side, x + 0.5 * length, length);
      x += length + random_.uniform(0.9, 3.0);
    }
  }

  // Upright, from below its lowest corner to above its highest.
  void add_house(const Side& side, double from, double to) {
    const double front = sidewalk + (random_.chance(0.5) ? 0.0 : random_.uniform(0.3, 2.0));
    const double depth = random_.uniform(8.0, 12.0);
    const double storeys = random_.uniform(5.0, 13.0);
    const double bay = random_.uniform(0.2, 0.9);
    double low = 1e9;
    double high = -1e9;
    for (const double x : {from, to}) {
      for (const double y : {front, front + depth}) {
        const double z = ground(side.at(x, y));
        low = std::min(low, z);
        high = std::max(high, z);
      }
    }
    upright_box(side, {from, front}, {to, front + depth}, low - 1.0, high + storeys);
    const double middle = 0.5 * (from + to);
    const double foot = ground(side.at(middle, front));
    upright_box(side, {middle - 1.2, front - bay}, {middle + 1.2, front}, foot + 2.7, foot + 4.6);
    const double step = std::min(0.5 * bay, 0.3);
    upright_box(side, {from + 1.0, front - step}, {from + 2.6, front}, low - 0.5, foot + 2.4);
  }

  void upright_box(
      const Side& side, const Vector2d& low, const Vector2d& high, double bottom, double top) {
    AlignedBox2d area(side.at(low.x(), low.y()));
    area.extend(side.at(high.x(), high.y()));
    hill_.world.primitives.push_back(make_box(ObjectClass::building,
                                              Rigid3{},
                                              {area.min().x(), area.min().y(), bottom},
                                              {area.max().x(), area.max().y(), top}));
  }

  void add_furniture(const Vector2d& place) {
    const Vector3d foot(place.x(), place.y(), ground(place) - 0.3);
    const double kind = random_.uniform();
    const double size = random_.uniform(0.7, 1.1);
    if (kind < 0.5) {
      hill_.world.primitives.push_back(
          make_cylinder(ObjectClass::trunk, Rigid3{}, foot, 0.18 * size, 3.4));
      const Rigid3 crown = planar_frame(foot + Vector3d(0, 0, 3.6), random_.uniform(0.0, pi));
      const Vector3d half = size * Vector3d(1.1, 0.9, 0.9);
      hill_.world.primitives.push_back(make_box(ObjectClass::crown, crown, -half, half));
    } else {
      hill_.world.primitives.push_back(
          make_cylinder(ObjectClass::pole, Rigid3{}, foot, 0.08 * size, 5.0 * size));
    }
  }

  // Its wheels stand on the plane below its middle.
  void add_car(const Side& side, double x, double length) {
    const Vector2d place = side.at(x, -1.0 + random_.uniform(-0.1, 0.1));
    const Vector3d up =
        Vector3d(-slope_at(along_x, place.x()), -slope_at(along_y, place.y()), 1.0).normalized();
    const double yaw =
        std::atan2(side.along.y(), side.along.x()) + (random_.chance(0.5) ? pi : 0.0);
    Rigid3 frame = planar_frame({place.x(), place.y(), road_height(place)}, yaw);
    frame.rotation = Eigen::Quaterniond::FromTwoVectors(Vector3d::UnitZ(), up) * frame.rotation;
    add_parked_car(hill_.world, frame, length, random_);
  }

  // Every kink of the profiles is a point of the way.
  void add_way() {
    const Vector2d low(-lane, -lane);
    const Vector2d high(hill_.length + lane, hill_.width + lane);
    const Vector2d corners[] = {{8.0, low.y()},
                                {high.x(), low.y()},
                                high,
                                {low.x(), high.y()},
                                low,
                                {high.x(), low.y()},
                                {high.x(), 40.0}};
    add_way_point(corners[0]);
    for (std::size_t k = 1; k < std::size(corners); ++k) {
      const Vector2d from = corners[k - 1];
      const Vector2d leg = corners[k] - from;
      const int axis = std::abs(leg.x()) > std::abs(leg.y()) ? 0 : 1;
      std::vector<double> parts{1.0};
      for (const double cut :
           axis == 0 ? cuts(along_x, hill_.length) : cuts(along_y, hill_.width)) {
        const double part = (cut - from[axis]) / leg[axis];
        if (part > 0.0 && part < 1.0) parts.push_back(part);
      }
      std::ranges::sort(parts);
      for (const double part : parts) add_way_point(from + part * leg);
    }
  }

  void add_way_point(const Vector2d& place) {
    hill_.way.emplace_back(place.x(), place.y(), road_height(place));
  }

  Hill hill_;
  Random random_;
};

}  // namespace

Hill make_hill(std::uint64_t seed) {
  return HillBuilder(seed).build();
}

}  // namespace kissmap::simulator
