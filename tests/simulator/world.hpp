// SPDX-License-Identifier: MIT
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cstdint>
#include <optional>
#include <vector>

#include "kissmap/geometry/rigid3.hpp"
#include "simulator/random.hpp"

namespace kissmap::simulator {

/// What a surface belongs to: the semantic ground truth of every return.
enum class ObjectClass : std::uint8_t {
  ground,
  sidewalk,
  building,
  fence,
  hedge,
  trunk,
  crown,
  pole,
  parked_car,  // outdoors
  floor,
  ceiling,
  wall,
  door,
  desk,
  desk_leg,
  chair_leg,
  chair_seat,
  cabinet,
  pillar,  // indoors
  moving_car,
  pedestrian,  // moving
};
inline constexpr int object_classes = 21;
const char* name(ObjectClass object_class);
bool is_moving(ObjectClass object_class);

enum class Shape : std::uint8_t { box, cylinder };

/// A solid. A box spans +-half_extents of its own frame; a cylinder stands along z of its own
/// frame, with radius half_extents.x() and half its height in half_extents.z(). A box with a slope
/// is sheared: at (x, y) of its frame it is shifted by slope . (x, y) along z, so its sides stay
/// upright while its top and bottom slope. Roads and ramps are such boxes: they meet without gaps.
struct Primitive {
  Shape shape = Shape::box;
  ObjectClass object_class = ObjectClass::building;
  Rigid3 world_from_object;
  Eigen::Vector3d half_extents = Eigen::Vector3d::Ones();  ///< m
  double reflectivity = 0.5;                               ///< 0..1, diffuse
  Eigen::Vector2d slope = Eigen::Vector2d::Zero();         ///< m/m, of boxes
};

/// The box between two corners given in a frame of your choice, with the reflectivity usual for
/// its class.
Primitive make_box(ObjectClass object_class,
                   const Rigid3& world_from_frame,
                   const Eigen::Vector3d& low_corner,
                   const Eigen::Vector3d& high_corner);

/// The upright cylinder of a frame, on `base`, the centre of its lower cap.
Primitive make_cylinder(ObjectClass object_class,
                        const Rigid3& world_from_frame,
                        const Eigen::Vector3d& base,
                        double radius,
                        double height);

/// Rotation by `yaw` [rad] about z, then translation.
Rigid3 planar_frame(const Eigen::Vector3d& origin, double yaw);

/// Signed distance [m] from a point to the surface; negative inside.
double signed_distance(const Primitive& primitive, const Eigen::Vector3d& point_in_world);

/// Goes to and fro along a line, smoothly: offset(t) = travel (1 - cos(2 pi (t / period +
/// phase)))/2.
struct Shuttle {
  Eigen::Vector3d travel = Eigen::Vector3d::Zero();  ///< m, world frame, from start to far end
  double period = 60.0;                              ///< s, there and back
  double phase = 0.0;                                ///< of a period

  Eigen::Vector3d offset(double time) const;
};

/// Solids that move together without turning; `parts` are placed where the shuttle starts.
struct MovingObject {
  std::vector<Primitive> parts;
  Shuttle shuttle;
};

/// An upright-sided, planar part of what is walked or driven on: height(x, y) = height + slope .
/// ((x, y) - area.min()). A ramp belongs to the levels at both of its ends.
struct FloorPiece {
  Eigen::AlignedBox2d area;  ///< m
  double height = 0.0;       ///< m, at area.min()
  Eigen::Vector2d slope = Eigen::Vector2d::Zero();
  int lowest_level = 0;
  int highest_level = 0;

  double height_at(const Eigen::Vector2d& place) const {
    return height + slope.dot(place - area.min());
  }
  bool on_level(int level) const { return lowest_level <= level && level <= highest_level; }
};

/// Everything a LiDAR can hit, and the truth about its floors. Plain data: add, remove and inspect
/// freely. z points up. Pieces of one level do not overlap; steps between them are no solids.
struct World {
  std::vector<Primitive> primitives;
  std::vector<MovingObject> moving;
  std::vector<FloorPiece> floors;
};

/// Exact height [m] of the floor of a level; the first of the pieces that meet there, nothing where
/// the level has no floor.
std::optional<double> floor_height(const World& world, double x, double y, int level = 0);

/// The two boxes of a parked car on its wheels: x to its front, origin on the road below its
/// middle.
void add_parked_car(World& world, const Rigid3& world_from_car, double length, Random& random);

/// Adds a piece of the floor and the solid below it, `depth` [m] thick.
void add_floor(World& world, ObjectClass object_class, const FloorPiece& piece, double depth);

}  // namespace kissmap::simulator
