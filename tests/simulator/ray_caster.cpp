// SPDX-License-Identifier: MIT
#include "simulator/ray_caster.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "simulator/intersect.hpp"

namespace kissmap::simulator {
namespace {

constexpr float far_away = 1e30F;
constexpr float bounds_slack = 1e-3F;  // m
constexpr std::size_t leaf_size = 2;
constexpr std::size_t bins = 16;

// A node still to be visited, and the range at which the ray meets it.
struct Waiting {
  float entry;
  std::uint32_t node;
};

double half_area(const Eigen::AlignedBox3d& box) {
  if (box.isEmpty()) return 0.0;
  const Eigen::Vector3d s = box.sizes();
  return s.x() * s.y() + s.y() * s.z() + s.z() * s.x();
}

// Targets whose centres fall into one slice of a node.
struct Bin {
  Eigen::AlignedBox3d box;
  int count = 0;

  void add(const Eigen::AlignedBox3d& other) {
    box.extend(other);
    ++count;
  }
  void add(const Bin& other) {
    box.extend(other.box);
    count += other.count;
  }
  double cost() const { return half_area(box) * count; }
};

// A node cut before one of its bins.
struct Cut {
  double cost = no_entry;
  std::size_t bin = 0;
};

Cut cheapest_cut(const std::array<Bin, bins>& filled) {
  std::array<Bin, bins> from_here;  // to the last
  for (std::size_t bin = bins; bin-- > 0;) {
    if (bin + 1 < bins) from_here[bin] = from_here[bin + 1];
    from_here[bin].add(filled[bin]);
  }
  Cut best;
  Bin before;
  for (std::size_t bin = 1; bin < bins; ++bin) {
    before.add(filled[bin - 1]);
    const double cost = before.cost() + from_here[bin].cost();
    const bool one_sided = before.count == 0 || from_here[bin].count == 0;
    if (!one_sided && cost < best.cost) best = {cost, bin};
  }
  return best;
}

Target make_target(const Primitive& primitive, std::int32_t shuttle) {
  Target target;
  target.object_from_world_rotation =
      primitive.world_from_object.rotation.conjugate().toRotationMatrix();
  target.centre = primitive.world_from_object.translation;
  target.half_extents = primitive.half_extents;
  target.slope = primitive.slope;
  target.shape = primitive.shape;
  target.shuttle = shuttle;
  target.primitive = &primitive;
  return target;
}

}  // namespace

struct RayCaster::Ray {
  Ray(const Eigen::Vector3d& from, const Eigen::Vector3d& along, double at)
      : origin(from), direction(along), time(at) {
    rough_origin << from.cast<float>().array(), 0.0F;
    // Finite even for rays along an axis, so that no NaN arises.
    rough_inverse << along.array().inverse().cast<float>().max(-1e30F).min(1e30F), 1.0F;
  }

  // Range at which the ray meets the box; `far_away` if it does not before `limit`.
  float entry(const Node& node, float limit) const {
    const Eigen::Array4f a = (node.low - rough_origin) * rough_inverse;
    const Eigen::Array4f b = (node.high - rough_origin) * rough_inverse;
    const float enter = a.min(b).maxCoeff();
    const float leave = std::min(limit, a.max(b).minCoeff());
    return enter <= leave ? enter : far_away;
  }

  Eigen::Vector3d origin;
  Eigen::Vector3d direction;
  double time;
  Eigen::Array4f rough_origin;
  Eigen::Array4f rough_inverse;
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
  set_large_apart();
  nodes_.reserve(2 * targets_.size());
  if (large_ < targets_.size()) build(large_, targets_.size());
}

// A ground that fills the world would blow up every node above it, so it stays out of the tree.
void RayCaster::set_large_apart() {
  Eigen::AlignedBox3d whole;
  for (const Target& target : targets_) whole.extend(bounds(target));
  const auto small = std::stable_partition(targets_.begin(), targets_.end(), [&](const Target& t) {
    return half_area(bounds(t)) > 0.2 * half_area(whole);
  });
  large_ = static_cast<std::size_t>(small - targets_.begin());
}

Eigen::AlignedBox3d RayCaster::bounds(const Target& target) const {
  Eigen::Vector3d half = target.half_extents;
  half.z() += target.slope.cwiseAbs().dot(half.head<2>());
  const Eigen::Vector3d reach = target.object_from_world_rotation.cwiseAbs().transpose() * half;
  // The walk through the tree is in single precision: good to 0.1 mm within a kilometre. The slack
  // is ten times that, so no grazing hit is lost.
  const Eigen::Vector3d slack = Eigen::Vector3d::Constant(bounds_slack);
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
  Node node;
  node.low << box.min().cast<float>().array(), 0.0F;
  node.high << box.max().cast<float>().array(), far_away;
  nodes_.push_back(node);
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
    return std::clamp(static_cast<std::size_t>(part * bins), std::size_t{0}, bins - 1);
  };
  Cut best;
  int best_axis = 0;
  for (int axis = 0; axis < 3; ++axis) {
    if (centres.sizes()[axis] <= 0.0) continue;
    std::array<Bin, bins> filled;
    for (std::size_t i = begin; i < end; ++i) {
      filled[bin_of(targets_[i], axis)].add(bounds(targets_[i]));
    }
    const Cut cut = cheapest_cut(filled);
    if (cut.cost >= best.cost) continue;
    best = cut;
    best_axis = axis;
  }
  if (best.cost == no_entry) return (begin + end) / 2;
  const auto at = [&](std::size_t i) { return targets_.begin() + static_cast<std::ptrdiff_t>(i); };
  const auto middle = std::stable_partition(at(begin), at(end), [&](const Target& target) {
    return bin_of(target, best_axis) < best.bin;
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
  const double range = enter(target.shape, origin, direction, target.half_extents, target.slope);
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
  const Eigen::Vector3d normal = surface_normal(target.shape,
                                                target.object_from_world_rotation * on_surface,
                                                target.half_extents,
                                                target.slope);
  return Hit{
      nearest.range, target.object_from_world_rotation.transpose() * normal, target.primitive};
}

std::optional<Hit> RayCaster::cast(const Eigen::Vector3d& origin,
                                   const Eigen::Vector3d& direction,
                                   double time,
                                   double max_range) const {
  const Ray ray{origin, direction, time};
  Nearest nearest{max_range};
  std::array<Waiting, 64> waiting;  // the tree is far less deep
  std::size_t count = 0;
  for (std::size_t i = 0; i < large_; ++i) test(targets_[i], ray, nearest);
  float limit = static_cast<float>(nearest.range) + bounds_slack;
  if (!nodes_.empty()) waiting[count++] = {0.0F, 0};
  while (count > 0) {
    const auto [entry, index] = waiting[--count];
    if (entry > limit) continue;
    const Node& node = nodes_[index];
    if (node.count > 0) {
      for (std::uint32_t i = 0; i < node.count; ++i) test(targets_[node.first + i], ray, nearest);
      limit = static_cast<float>(nearest.range) + bounds_slack;
      continue;
    }
    Waiting near{ray.entry(nodes_[index + 1], limit), index + 1};
    Waiting far{ray.entry(nodes_[node.first], limit), node.first};
    if (far.entry < near.entry) std::swap(near, far);
    if (far.entry < far_away) waiting.at(count++) = far;
    if (near.entry < far_away) waiting.at(count++) = near;
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
  double nearest = no_entry;
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
