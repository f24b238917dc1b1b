// SPDX-License-Identifier: MIT
#include "simulator/intersect.hpp"

#include <algorithm>
#include <cmath>

namespace kissmap::simulator {
namespace {

double enter_box(const Eigen::Array3d& origin,
                 const Eigen::Array3d& direction,
                 const Eigen::Array3d& half) {
  double enter = -no_entry;
  double leave = no_entry;
  for (int axis = 0; axis < 3; ++axis) {
    if (direction[axis] == 0.0) {
      if (std::abs(origin[axis]) > half[axis]) return no_entry;
      continue;
    }
    const double inverse = 1.0 / direction[axis];
    const double middle = -origin[axis] * inverse;
    const double reach = half[axis] * std::abs(inverse);
    enter = std::max(enter, middle - reach);
    leave = std::min(leave, middle + reach);
  }
  return enter > 0.0 && enter <= leave ? enter : no_entry;
}

double enter_cylinder(const Eigen::Array3d& origin,
                      const Eigen::Array3d& direction,
                      const Eigen::Array3d& half) {
  double enter = -no_entry;
  double leave = no_entry;
  if (direction.z() != 0.0) {
    const double middle = -origin.z() / direction.z();
    const double reach = half.z() / std::abs(direction.z());
    enter = middle - reach;
    leave = middle + reach;
  } else if (std::abs(origin.z()) > half.z()) {
    return no_entry;
  }
  const double a = direction.x() * direction.x() + direction.y() * direction.y();
  const double b = origin.x() * direction.x() + origin.y() * direction.y();
  const double c = origin.x() * origin.x() + origin.y() * origin.y() - half.x() * half.x();
  if (a > 0.0) {
    const double discriminant = b * b - a * c;
    if (discriminant < 0.0) return no_entry;
    enter = std::max(enter, (-b - std::sqrt(discriminant)) / a);
    leave = std::min(leave, (-b + std::sqrt(discriminant)) / a);
  } else if (c > 0.0) {
    return no_entry;
  }
  return enter > 0.0 && enter <= leave ? enter : no_entry;
}

Eigen::Vector3d unsheared(const Eigen::Vector3d& vector, const Eigen::Vector2d& slope) {
  return {vector.x(), vector.y(), vector.z() - slope.dot(vector.head<2>())};
}

}  // namespace

double enter(Shape shape,
             const Eigen::Vector3d& origin,
             const Eigen::Vector3d& direction,
             const Eigen::Vector3d& half_extents,
             const Eigen::Vector2d& slope) {
  if (shape == Shape::cylinder) return enter_cylinder(origin, direction, half_extents);
  // Undoing the shear keeps ranges: points of the ray move, the parameter along it does not.
  return enter_box(unsheared(origin, slope), unsheared(direction, slope), half_extents);
}

Eigen::Vector3d surface_normal(Shape shape,
                               const Eigen::Vector3d& point,
                               const Eigen::Vector3d& half,
                               const Eigen::Vector2d& slope) {
  const Eigen::Vector3d p = unsheared(point, slope);
  Eigen::Vector3d normal = Eigen::Vector3d::Zero();
  int axis = 2;
  if (shape == Shape::box) {
    (p.cwiseAbs() - half).maxCoeff(&axis);
  } else {
    const double radius = std::hypot(p.x(), p.y());
    if (radius - half.x() > std::abs(p.z()) - half.z()) return {p.x() / radius, p.y() / radius, 0};
  }
  normal[axis] = p[axis] < 0 ? -1.0 : 1.0;
  if (axis == 2) normal.head<2>() -= normal.z() * slope;
  return normal.normalized();
}

}  // namespace kissmap::simulator
