// SPDX-License-Identifier: MIT
#include "simulator/ray_caster.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

namespace kissmap::simulator {
namespace {

constexpr double nothing = std::numeric_limits<double>::infinity();
constexpr std::size_t leaf_size = 2;
constexpr int bins = 16;

// Where a ray in the frame of the solid enters it; `nothing` if it misses or starts inside.
double enter_box(const Eigen::Array3d& origin,
                 const Eigen::Array3d& direction,
                 const Eigen::Array3d& half) {
  double enter = -nothing;
  double leave = nothing;
  for (int axis = 0; axis < 3; ++axis) {
    if (direction[axis] == 0.0) {
      if (std::abs(origin[axis]) > half[axis]) return nothing;
      continue;
    }
    const double inverse = 1.0 / direction[axis];
    const double middle = -origin[axis] * inverse;
    const double reach = half[axis] * std::abs(inverse);
    enter = std::max(enter, middle - reach);
    leave = std::min(leave, middle + reach);
  }
  return enter > 0.0 && enter <= leave ? enter : nothing;
}

double enter_cylinder(const Eigen::Array3d& origin,
                      const Eigen::Array3d& direction,
                      const Eigen::Array3d& half) {
  double enter = -nothing;
  double leave = nothing;
  if (direction.z() != 0.0) {
    const double middle = -origin.z() / direction.z();
    const double reach = half.z() / std::abs(direction.z());
    enter = middle - reach;
    leave = middle + reach;
  } else if (std::abs(origin.z()) > half.z()) {
    return nothing;
  }
  const double a = direction.x() * direction.x() + direction.y() * direction.y();
  const double b = origin.x() * direction.x() + origin.y() * direction.y();
  const double c = origin.x() * origin.x() + origin.y() * origin.y() - half.x() * half.x();
  if (a > 0.0) {
    const double discriminant = b * b - a * c;
    if (discriminant < 0.0) return nothing;
    enter = std::max(enter, (-b - std::sqrt(discriminant)) / a);
    leave = std::min(leave, (-b + std::sqrt(discriminant)) / a);
  } else if (c > 0.0) {
    return nothing;
  }
  return enter > 0.0 && enter <= leave ? enter : nothing;
}

// Outward normal at a point of the surface, in the frame of the solid: that of the nearest face.
Eigen::Vector3d surface_normal(Shape shape, const Eigen::Vector3d& p, const Eigen::Vector3d& half) {
  Eigen::Vector3d normal = Eigen::Vector3d::Zero();
  int axis = 2;
  if (shape == Shape::box) {
    (p.cwiseAbs() - half).maxCoeff(&axis);
  } else {
    const double radius = std::hypot(p.x(), p.y());
    if (radius - half.x() > std::abs(p.z()) - half.z()) return {p.x() / radius, p.y() / radius, 0};
  }
  normal[axis] = p[axis] < 0 ? -1.0 : 1.0;
  return normal;
}

Target make_target(const Primitive& primitive, std::int32_t shuttle) {
  Target target;
  target.object_from_world_rotation =
      primitive.world_from_object.rotation.conjugate().toRotationMatrix();
  target.centre = primitive.world_from_object.translation;
  target.half_extents = primitive.half_extents;
  target.shape = primitive.shape;
  target.shuttle = shuttle;
  target.primitive = &primitive;
  return target;
}

}  // namespace

struct RayCaster::Ray {
  Eigen::Vector3d origin;
  Eigen::Vector3d direction;
  double time;
  Eigen::Array3d inverse = direction.array().inverse();

  // Whether the ray meets the box before `limit`. A ray in the plane of a face yields NaN, which
  // the order of the arguments of min and max lets pass.
  double entry(const Node& node, double limit) const {
    const Eigen::Array3d a = (node.low - origin.array()) * inverse;
    const Eigen::Array3d b = (node.high - origin.array()) * inverse;
    double enter = 0.0;
    double leave = limit;
    for (int axis = 0; axis < 3; ++axis) {
      enter = std::max(enter, std::min(a[axis], b[axis]));
      leave = std::min(leave, std::max(a[axis], b[axis]));
    }
    return enter <= leave ? enter : nothing;
  }
};

struct RayCaster::Nearest {
  double range;
  const Target* target = nullptr;
};

RayCaster::RayCaster(World world) : world_(std::move(world)) {
  for (const Primitive& primitive : world_.primitives)
    targets_.push_back(make_target(primitive, -1));
  for (std::size_t i = 0; i < world_.moving.size(); ++i) {
    for (const Primitive& part : world_.moving[i].parts) {
      targets_.push_back(make_target(part, static_cast<std::int32_t>(i)));
    }
  }
  for (std::size_t i = 0; i < targets_.size(); ++i) {
    targets_[i].order = static_cast<std::uint32_t>(i);
  }
  nodes_.reserve(2 * targets_.size());
  if (!targets_.empty()) build(0, targets_.size());
}

Eigen::AlignedBox3d RayCaster::bounds(const Target& target) const {
  const Eigen::Vector3d reach =
      target.object_from_world_rotation.cwiseAbs().transpose() * target.half_extents;
  // A hair of slack, so that rounding in the walk through the tree never loses a grazing hit.
  const Eigen::Vector3d slack = Eigen::Vector3d::Constant(1e-6);
  Eigen::AlignedBox3d box(target.centre - reach - slack, target.centre + reach + slack);
  if (target.shuttle >= 0) {
    const Eigen::Vector3d travel =
        world_.moving[static_cast<std::size_t>(target.shuttle)].shuttle.travel;
    box.extend(Eigen::AlignedBox3d(box.min() + travel, box.max() + travel));
  }
  return box;
}

void RayCaster::build(std::size_t begin, std::size_t end) {
  Eigen::AlignedBox3d box;
  Eigen::AlignedBox3d centres;
  for (std::size_t i = begin; i < end; ++i) {
    const Eigen::AlignedBox3d target_box = bounds(targets_[i]);
    box.extend(target_box);
    centres.extend(target_box.center());
  }
  const std::size_t own = nodes_.size();
  nodes_.push_back({box.min().array(), box.max().array(), 0, 0});
  if (end - begin <= leaf_size) {
    nodes_[own].first = static_cast<std::uint32_t>(begin);
    nodes_[own].count = static_cast<std::uint32_t>(end - begin);
    return;
  }
  const std::size_t middle = split(begin, end, centres);
  build(begin, middle);
  nodes_[own].first = static_cast<std::uint32_t>(nodes_.size());
  build(middle, end);
}

// Binned surface area heuristic (Wald, RT 2007) over the three axes; halves where it finds none.
std::size_t RayCaster::split(std::size_t begin,
                             std::size_t end,
                             const Eigen::AlignedBox3d& centres) {
  const auto bin_of = [&](const Target& target, int axis) {
    const double part =
        (bounds(target).center()[axis] - centres.min()[axis]) / centres.sizes()[axis];
    return std::clamp(static_cast<int>(part * bins), 0, bins - 1);
  };
  const auto half_area = [](const Eigen::AlignedBox3d& box) {
    const Eigen::Vector3d s = box.isEmpty() ? Eigen::Vector3d::Zero().eval() : box.sizes().eval();
    return s.x() * s.y() + s.y() * s.z() + s.z() * s.x();
  };
  double best_cost = nothing;
  int best_axis = 0;
  int best_bin = 0;
  for (int axis = 0; axis < 3; ++axis) {
    if (centres.sizes()[axis] <= 0.0) continue;
    std::array<Eigen::AlignedBox3d, bins> boxes;
    std::array<int, bins> counts{};
    for (std::size_t i = begin; i < end; ++i) {
      const auto bin = static_cast<std::size_t>(bin_of(targets_[i], axis));
      boxes[bin].extend(bounds(targets_[i]));
      ++counts[bin];
    }
    std::array<double, bins> right_cost{};
    Eigen::AlignedBox3d right;
    for (int bin = bins - 1, n = 0; bin > 0; --bin) {
      right.extend(boxes[static_cast<std::size_t>(bin)]);
      n += counts[static_cast<std::size_t>(bin)];
      right_cost[static_cast<std::size_t>(bin)] = half_area(right) * n;
    }
    Eigen::AlignedBox3d left;
    for (int bin = 1, n = 0; bin < bins; ++bin) {
      left.extend(boxes[static_cast<std::size_t>(bin - 1)]);
      n += counts[static_cast<std::size_t>(bin - 1)];
      const double cost = half_area(left) * n + right_cost[static_cast<std::size_t>(bin)];
      if (n == 0 || n == static_cast<int>(end - begin) || cost >= best_cost) continue;
      best_cost = cost;
      best_axis = axis;
      best_bin = bin;
    }
  }
  const auto at = [&](std::size_t i) { return targets_.begin() + static_cast<std::ptrdiff_t>(i); };
  if (best_cost == nothing) return (begin + end) / 2;
  const auto middle = std::stable_partition(at(begin), at(end), [&](const Target& target) {
    return bin_of(target, best_axis) < best_bin;
  });
  return static_cast<std::size_t>(middle - targets_.begin());
}

void RayCaster::test(const Target& target, const Ray& ray, Nearest& nearest) const {
  Eigen::Vector3d from_centre = ray.origin - target.centre;
  if (target.shuttle >= 0) {
    from_centre -= world_.moving[static_cast<std::size_t>(target.shuttle)].shuttle.offset(ray.time);
  }
  const Eigen::Vector3d origin = target.object_from_world_rotation * from_centre;
  const Eigen::Vector3d direction = target.object_from_world_rotation * ray.direction;
  const double range = target.shape == Shape::box
                           ? enter_box(origin, direction, target.half_extents)
                           : enter_cylinder(origin, direction, target.half_extents);
  // Shared faces: the first solid of the world wins, whatever the order of the tests.
  const bool tie =
      range == nearest.range && nearest.target != nullptr && target.order < nearest.target->order;
  if (range < nearest.range || tie) nearest = {range, &target};
}

std::optional<Hit> RayCaster::finish(const Ray& ray, const Nearest& nearest) const {
  if (nearest.target == nullptr) return std::nullopt;
  const Target& target = *nearest.target;
  Eigen::Vector3d centre = target.centre;
  if (target.shuttle >= 0) {
    centre += world_.moving[static_cast<std::size_t>(target.shuttle)].shuttle.offset(ray.time);
  }
  const Eigen::Vector3d on_surface = ray.origin + nearest.range * ray.direction - centre;
  const Eigen::Vector3d normal = surface_normal(
      target.shape, target.object_from_world_rotation * on_surface, target.half_extents);
  return Hit{
      nearest.range, target.object_from_world_rotation.transpose() * normal, target.primitive};
}

std::optional<Hit> RayCaster::cast(const Eigen::Vector3d& origin,
                                   const Eigen::Vector3d& direction,
                                   double time,
                                   double max_range) const {
  const Ray ray{origin, direction, time};
  Nearest nearest{max_range};
  std::array<std::pair<double, std::uint32_t>, 64> stack;
  std::size_t depth = 0;
  if (!nodes_.empty()) stack[depth++] = {0.0, 0};
  while (depth > 0) {
    const auto [entry, index] = stack[--depth];
    if (entry > nearest.range) continue;
    const Node& node = nodes_[index];
    for (std::uint32_t i = 0; i < node.count; ++i) test(targets_[node.first + i], ray, nearest);
    if (node.count > 0) continue;
    std::pair near{ray.entry(nodes_[index + 1], nearest.range), index + 1};
    std::pair far{ray.entry(nodes_[node.first], nearest.range), node.first};
    if (far.first < near.first) std::swap(near, far);
    if (far.first != nothing) stack.at(depth++) = far;
    if (near.first != nothing) stack.at(depth++) = near;
  }
  return finish(ray, nearest);
}

std::optional<Hit> RayCaster::cast_by_brute_force(const Eigen::Vector3d& origin,
                                                  const Eigen::Vector3d& direction,
                                                  double time,
                                                  double max_range) const {
  const Ray ray{origin, direction, time};
  Nearest nearest{max_range};
  for (const Target& target : targets_) test(target, ray, nearest);
  return finish(ray, nearest);
}

double RayCaster::distance(const Eigen::Vector3d& point_in_world, double time) const {
  double nearest = nothing;
  for (const Primitive& primitive : world_.primitives) {
    nearest = std::min(nearest, signed_distance(primitive, point_in_world));
  }
  for (const MovingObject& object : world_.moving) {
    const Eigen::Vector3d point = point_in_world - object.shuttle.offset(time);
    for (const Primitive& part : object.parts) {
      nearest = std::min(nearest, signed_distance(part, point));
    }
  }
  return nearest;
}

}  // namespace kissmap::simulator
