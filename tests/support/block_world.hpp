// SPDX-License-Identifier: MIT
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <random>
#include <vector>

#include "kissmap/mapping/local_map.hpp"
#include "kissmap/mapping/surfels.hpp"
#include "kissmap/odometry/voxel_hash_map.hpp"
#include "support/random_clouds.hpp"

namespace kissmap {

/// Points on the walls of houses strewn over a level ground, `half_extent` [m] to each side.
inline std::vector<Eigen::Vector3f> block_world(std::uint64_t seed, float half_extent = 50.0F) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<float> place(-half_extent, half_extent);
  std::uniform_real_distribution<float> size(3.0F, 12.0F);
  std::uniform_real_distribution<float> height(2.5F, 8.0F);
  std::uniform_real_distribution<float> unit(0.0F, 1.0F);
  std::vector<Eigen::Vector3f> points;
  for (float x = -half_extent; x < half_extent; x += 0.4F) {
    for (float y = -half_extent; y < half_extent; y += 0.4F) {
      points.emplace_back(x + 0.3F * unit(random), y + 0.3F * unit(random), 0.0F);
    }
  }
  for (int house = 0; house < 30; ++house) {
    const Eigen::Vector2f corner(place(random), place(random));
    const Eigen::Vector2f sides(size(random), size(random));
    const float angle = 3.0F * unit(random);
    const Eigen::Vector2f along(std::cos(angle), std::sin(angle));
    const Eigen::Vector2f across(-along.y(), along.x());
    const float top = height(random);
    const auto wall = [&](const Eigen::Vector2f& from, const Eigen::Vector2f& direction, float w) {
      for (float s = 0.0F; s < w; s += 0.2F) {
        for (float z = 0.0F; z < top; z += 0.2F) {
          const Eigen::Vector2f at = from + (s + 0.15F * unit(random)) * direction;
          points.emplace_back(at.x(), at.y(), z + 0.15F * unit(random));
        }
      }
    };
    wall(corner, along, sides.x());
    wall(corner, across, sides.y());
    wall(corner + sides.x() * along, across, sides.y());
    wall(corner + sides.y() * across, along, sides.x());
  }
  return points;
}

inline SurfelCloud surfels_of(const std::vector<Eigen::Vector3f>& points, double voxel_size = 0.5) {
  VoxelHashMap grid(voxel_size, 20);
  grid.add(points);
  return surfels_from_grid(grid);
}

/// x, y [m] and yaw [degrees], with a little roll, pitch and height as between two local maps.
inline Rigid3 planar_motion(double x, double y, double yaw) {
  Rigid3 motion;
  motion.rotation = Eigen::AngleAxisd(yaw * 0.017453292519943295, Eigen::Vector3d::UnitZ()) *
                    Eigen::AngleAxisd(0.01, Eigen::Vector3d::UnitX()) *
                    Eigen::AngleAxisd(-0.015, Eigen::Vector3d::UnitY());
  motion.translation = {x, y, 0.4};
  return motion;
}

}  // namespace kissmap
