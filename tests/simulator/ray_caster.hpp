// SPDX-License-Identifier: MIT
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cstdint>
#include <optional>
#include <vector>

#include "simulator/world.hpp"

namespace kissmap::simulator {

struct Hit {
  double range = 0.0;                                 ///< m along the unit direction
  Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();  ///< unit, outward, world frame
  const Primitive* primitive = nullptr;               ///< owned by the caster
};

/// A solid prepared for many rays.
struct Target {
  Eigen::Matrix3d object_from_world_rotation;
  Eigen::Vector3d centre;
  Eigen::Vector3d half_extents;
  Eigen::Vector2d slope = Eigen::Vector2d::Zero();
  Shape shape = Shape::box;
  std::int32_t shuttle = -1;  ///< index of the moving object, or -1
  std::uint32_t order = 0;    ///< place in the world; decides between equal ranges
  const Primitive* primitive = nullptr;
};

/// Finds what a ray hits first, exactly (no sampling, double precision), with a bounding volume
/// hierarchy. Moving objects are found through the box around their whole path. Immutable, so
/// any number of threads may cast at once. A ray that starts inside a solid does not see it.
class RayCaster {
 public:
  explicit RayCaster(World world);
  RayCaster(const RayCaster&) = delete;
  RayCaster& operator=(const RayCaster&) = delete;

  const World& world() const { return world_; }

  /// `direction` has unit length; `time` [s] places the moving objects; nothing beyond
  /// `max_range` [m] is seen.
  std::optional<Hit> cast(const Eigen::Vector3d& origin,
                          const Eigen::Vector3d& direction,
                          double time,
                          double max_range) const;

  /// The same answer by testing every solid: the oracle of the tests.
  std::optional<Hit> cast_by_brute_force(const Eigen::Vector3d& origin,
                                         const Eigen::Vector3d& direction,
                                         double time,
                                         double max_range) const;

  /// Distance [m] to the nearest surface at `time`; negative inside a solid. By brute force.
  double distance(const Eigen::Vector3d& point_in_world, double time) const;

 private:
  // Single precision with slack, four lanes for SSE. Lane 3 is the ray itself: 0 to far away.
  struct Node {
    Eigen::Array4f low;
    Eigen::Array4f high;
    std::uint32_t first = 0;  ///< leaf: first target; inner node: right child (left is next)
    std::uint32_t count = 0;  ///< targets of a leaf; 0 marks an inner node
  };
  struct Ray;
  struct Nearest;

  void set_large_apart();
  void build(std::size_t begin, std::size_t end);
  std::size_t split(std::size_t begin, std::size_t end, const Eigen::AlignedBox3d& centres);
  Eigen::AlignedBox3d bounds(const Target& target) const;
  void test(const Target& target, const Ray& ray, Nearest& nearest) const;
  std::optional<Hit> finish(const Ray& ray, const Nearest& nearest) const;

  World world_;
  std::vector<Target> targets_;
  std::size_t large_ = 0;  ///< targets at the front that are not in the tree
  std::vector<Node> nodes_;
};

}  // namespace kissmap::simulator
