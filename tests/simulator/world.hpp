// SPDX-License-Identifier: MIT
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "kissmap/geometry/rigid3.hpp"

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
  chair_leg,
  chair_seat,
  cabinet,  // indoors
  moving_car,
  pedestrian,  // moving
};
const char* name(ObjectClass object_class);
bool is_moving(ObjectClass object_class);

enum class Shape : std::uint8_t { box, cylinder };

/// A solid. A box spans +-half_extents of its own frame; a cylinder stands along z of its own
/// frame, with radius half_extents.x() and half its height in half_extents.z().
struct Primitive {
  Shape shape = Shape::box;
  ObjectClass object_class = ObjectClass::building;
  Rigid3 world_from_object;
  Eigen::Vector3d half_extents = Eigen::Vector3d::Ones();  ///< m
  double reflectivity = 0.5;                               ///< 0..1, diffuse
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

/// Everything a LiDAR can hit. Plain data: add, remove and inspect freely. z points up.
struct World {
  std::vector<Primitive> primitives;
  std::vector<MovingObject> moving;
};

}  // namespace kissmap::simulator
