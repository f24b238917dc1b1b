// SPDX-License-Identifier: MIT
#include "simulator/world.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

namespace kissmap::simulator {
namespace {

struct ClassFacts {
  const char* name;
  double reflectivity;
};

// In the order of ObjectClass.
constexpr std::array<ClassFacts, object_classes> class_facts{{
    {"ground", 0.15},    {"sidewalk", 0.3}, {"building", 0.5},  {"fence", 0.4},
    {"hedge", 0.45},     {"trunk", 0.3},    {"crown", 0.55},    {"pole", 0.6},
    {"parked_car", 0.7}, {"floor", 0.25},   {"ceiling", 0.8},   {"wall", 0.7},
    {"door", 0.5},       {"desk", 0.45},    {"desk_leg", 0.45}, {"chair_leg", 0.35},
    {"chair_seat", 0.2}, {"cabinet", 0.55}, {"pillar", 0.6},    {"moving_car", 0.7},
    {"pedestrian", 0.4},
}};

const ClassFacts& facts(ObjectClass object_class) {
  return class_facts.at(static_cast<std::size_t>(object_class));
}

double box_distance(const Eigen::Array3d& outside) {
  return outside.max(0.0).matrix().norm() + std::min(0.0, outside.maxCoeff());
}

// Distance to the parallelogram middle + [-1, 1] u + [-1, 1] v.
double parallelogram_distance(const Eigen::Vector3d& point,
                              const Eigen::Vector3d& u,
                              const Eigen::Vector3d& v) {
  const auto to_segment = [&point](const Eigen::Vector3d& middle, const Eigen::Vector3d& half) {
    const double part = std::clamp((point - middle).dot(half) / half.squaredNorm(), -1.0, 1.0);
    return (point - middle - part * half).norm();
  };
  Eigen::Matrix2d gram;
  gram << u.squaredNorm(), u.dot(v), u.dot(v), v.squaredNorm();
  const Eigen::Vector2d foot = gram.inverse() * Eigen::Vector2d(point.dot(u), point.dot(v));
  if (foot.cwiseAbs().maxCoeff() <= 1.0) return std::abs(point.dot(u.cross(v).normalized()));
  return std::min({to_segment(u, v), to_segment(-u, v), to_segment(v, u), to_segment(-v, u)});
}

double sheared_box_distance(const Primitive& box, const Eigen::Vector3d& p) {
  const Eigen::Vector3d& half = box.half_extents;
  const Eigen::Vector3d edges[3] = {{half.x(), 0.0, half.x() * box.slope.x()},
                                    {0.0, half.y(), half.y() * box.slope.y()},
                                    {0.0, 0.0, half.z()}};
  double outside = std::numeric_limits<double>::infinity();
  double inside = -outside;
  for (int axis = 0; axis < 3; ++axis) {
    const Eigen::Vector3d& u = edges[(axis + 1) % 3];
    const Eigen::Vector3d& v = edges[(axis + 2) % 3];
    const Eigen::Vector3d normal = u.cross(v).normalized();
    for (const double sign : {-1.0, 1.0}) {
      const Eigen::Vector3d from_face = p - sign * edges[axis];
      outside = std::min(outside, parallelogram_distance(from_face, u, v));
      inside = std::max(inside, sign * normal.dot(from_face));
    }
  }
  return inside <= 0.0 ? inside : outside;
}

}  // namespace

const char* name(ObjectClass object_class) {
  return facts(object_class).name;
}

bool is_moving(ObjectClass object_class) {
  return object_class == ObjectClass::moving_car || object_class == ObjectClass::pedestrian;
}

Primitive make_box(ObjectClass object_class,
                   const Rigid3& world_from_frame,
                   const Eigen::Vector3d& low_corner,
                   const Eigen::Vector3d& high_corner) {
  Primitive box;
  box.shape = Shape::box;
  box.object_class = object_class;
  box.world_from_object = {world_from_frame.rotation,
                           world_from_frame * (0.5 * (low_corner + high_corner))};
  box.half_extents = 0.5 * (high_corner - low_corner).cwiseAbs();
  box.reflectivity = facts(object_class).reflectivity;
  return box;
}

Primitive make_cylinder(ObjectClass object_class,
                        const Rigid3& world_from_frame,
                        const Eigen::Vector3d& base,
                        double radius,
                        double height) {
  const Eigen::Vector3d half(radius, radius, 0.5 * height);
  Primitive cylinder = make_box(object_class,
                                world_from_frame,
                                base - Eigen::Vector3d(radius, radius, 0.0),
                                base + Eigen::Vector3d(radius, radius, height));
  cylinder.shape = Shape::cylinder;
  cylinder.half_extents = half;
  return cylinder;
}

Rigid3 planar_frame(const Eigen::Vector3d& origin, double yaw) {
  return {Eigen::Quaterniond(Eigen::AngleAxisd(yaw, Eigen::Vector3d::UnitZ())), origin};
}

double signed_distance(const Primitive& primitive, const Eigen::Vector3d& point_in_world) {
  const Eigen::Vector3d p = primitive.world_from_object.inverse() * point_in_world;
  const Eigen::Vector3d& half = primitive.half_extents;
  if (!primitive.slope.isZero(0.0)) return sheared_box_distance(primitive, p);
  if (primitive.shape == Shape::box) return box_distance(p.array().abs() - half.array());
  const double radial = std::hypot(p.x(), p.y()) - half.x();
  const double axial = std::abs(p.z()) - half.z();
  return std::hypot(std::max(radial, 0.0), std::max(axial, 0.0)) +
         std::min(0.0, std::max(radial, axial));
}

std::optional<double> floor_height(const World& world, double x, double y, int level) {
  const Eigen::Vector2d place(x, y);
  for (const FloorPiece& piece : world.floors) {
    if (piece.on_level(level) && piece.area.contains(place)) return piece.height_at(place);
  }
  return std::nullopt;
}

void add_parked_car(World& world, const Rigid3& world_from_car, double length, Random& random) {
  const double half = 0.5 * length;
  const double cabin_front = random.uniform(0.1, 0.5) * length;
  const double roof = random.uniform(1.35, 1.9);
  world.primitives.push_back(
      make_box(ObjectClass::parked_car, world_from_car, {-half, -0.88, 0.25}, {half, 0.88, 0.85}));
  world.primitives.push_back(make_box(ObjectClass::parked_car,
                                      world_from_car,
                                      {-half + 0.2, -0.78, 0.85},
                                      {cabin_front, 0.78, roof}));
}

void add_floor(World& world, ObjectClass object_class, const FloorPiece& piece, double depth) {
  const Eigen::Vector2d middle = piece.area.center();
  const Eigen::Vector2d half = 0.5 * piece.area.sizes();
  const double height = piece.height_at(middle);
  Primitive solid = make_box(object_class,
                             Rigid3{},
                             {middle.x() - half.x(), middle.y() - half.y(), height - depth},
                             {middle.x() + half.x(), middle.y() + half.y(), height});
  solid.slope = piece.slope;
  world.primitives.push_back(solid);
  world.floors.push_back(piece);
}

Eigen::Vector3d Shuttle::offset(double time) const {
  const double turns = time / period + phase;
  return 0.5 * (1.0 - std::cos(2.0 * std::numbers::pi * turns)) * travel;
}

}  // namespace kissmap::simulator
