// SPDX-License-Identifier: MIT
// Points registered to planes, and what a registration is worth where planes leave a way open.
#include "kissmap/loop_closing/surfel_registration.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <random>

#include "support/matchers.hpp"
#include "support/random_clouds.hpp"

namespace kissmap {
namespace {

constexpr double voxel = 0.5;  // m
constexpr GuessSigmas sigmas{0.05, 0.02};

/// Surfels of a corridor along x, 2 m wide and 3 m high, with walls at its ends if asked for.
SurfelCloud corridor(bool ends) {
  SurfelCloud surfels;
  const auto add = [&surfels](double x, double y, double z, const Eigen::Vector3f& normal) {
    surfels.means.emplace_back(Eigen::Vector3d(x, y, z).cast<float>());
    surfels.normals.push_back(normal);
  };
  for (double x = -9.75; x < 10.0; x += voxel) {
    for (double z = -1.25; z < 1.5; z += voxel) {
      add(x, 1.0, z, -Eigen::Vector3f::UnitY());
      add(x, -1.0, z, Eigen::Vector3f::UnitY());
    }
    for (double y = -0.75; y < 1.0; y += voxel) {
      add(x, y, -1.5, Eigen::Vector3f::UnitZ());
      add(x, y, 1.5, -Eigen::Vector3f::UnitZ());
    }
  }
  if (!ends) return surfels;
  for (double y = -0.75; y < 1.0; y += voxel) {
    for (double z = -1.25; z < 1.5; z += voxel) {
      for (int layer = 0; layer < 6; ++layer) {  // as many planes as a tenth of the others
        add(10.0 + layer, y, z, -Eigen::Vector3f::UnitX());
        add(-10.0 - layer, y, z, Eigen::Vector3f::UnitX());
      }
    }
  }
  return surfels;
}

TEST(SurfelMap, FindsTheNearestOfTheVoxelsAroundAsAnExhaustiveSearchDoes) {
  std::mt19937 random(7);
  std::uniform_real_distribution<float> coordinate(-3.0F, 3.0F);
  const auto any_point = [&] {
    return Eigen::Vector3f(coordinate(random), coordinate(random), coordinate(random));
  };
  SurfelCloud surfels;
  for (int i = 0; i < 1500; ++i) {
    surfels.means.push_back(any_point());
    surfels.normals.push_back(any_point().normalized());
  }
  const SurfelMap map(surfels, voxel);
  const auto per_metre = static_cast<float>(1.0 / voxel);
  std::vector<std::size_t> kept;  // the first of each voxel
  for (std::size_t i = 0; i < surfels.size(); ++i) {
    const Voxel own = voxel_of(surfels.means[i], per_metre);
    if (std::ranges::none_of(kept, [&](std::size_t other) {
          return voxel_of(surfels.means[other], per_metre) == own;
        })) {
      kept.push_back(i);
    }
  }
  EXPECT_EQ(map.surfels().size(), kept.size());
  int without = 0;
  for (int i = 0; i < 2000; ++i) {
    const Eigen::Vector3f point = 1.2F * any_point();
    const Voxel center = voxel_of(point, per_metre);
    std::optional<std::size_t> best;
    std::vector<float> distances;
    bool occupied = false;
    for (const std::size_t other : kept) {
      const Voxel at = voxel_of(surfels.means[other], per_metre);
      if (at == center) occupied = true;
      if (std::abs(at.x - center.x) > 1 || std::abs(at.y - center.y) > 1 ||
          std::abs(at.z - center.z) > 1) {
        continue;
      }
      distances.push_back((surfels.means[other] - point).norm());
      if (!best || (surfels.means[other] - point).squaredNorm() <
                       (surfels.means[*best] - point).squaredNorm()) {
        best = other;
      }
    }
    EXPECT_EQ(map.occupied(point), occupied);
    const SurfelMap::Nearest found = map.nearest(point);
    ASSERT_EQ(found.surfel >= 0, best.has_value());
    distances.resize(std::max<std::size_t>(2, distances.size()),
                     std::numeric_limits<float>::infinity());
    std::ranges::sort(distances);
    EXPECT_FLOAT_EQ(found.distance, distances[0]);
    EXPECT_FLOAT_EQ(found.next_distance, distances[1]);
    if (!best) {
      ++without;
      continue;
    }
    const auto at = static_cast<std::size_t>(found.surfel);
    EXPECT_EQ(map.surfels().means[at], surfels.means[*best]);
    EXPECT_EQ(map.surfels().normals[at], surfels.normals[*best]);
  }
  EXPECT_GT(without, 50);
  EXPECT_LT(without, 1000);
}

TEST(NearestSurfels, AreThoseOfASearchWhereverTheSamplesMove) {
  std::mt19937 random(11);
  std::uniform_real_distribution<float> coordinate(-3.0F, 3.0F);
  std::normal_distribution<float> step(0.0F, 1.0F);
  const auto strewn = [&](auto& along, float scale) -> Eigen::Vector3f {
    return scale * Eigen::Vector3f(along(random), along(random), along(random));
  };
  SurfelCloud surfels;
  for (int i = 0; i < 1500; ++i) {
    surfels.means.push_back(strewn(coordinate, 1.0F));
    surfels.normals.emplace_back(Eigen::Vector3f::UnitZ());
  }
  const SurfelMap map(surfels, voxel);
  std::vector<Eigen::Vector3f> samples;
  for (int i = 0; i < 300; ++i) samples.push_back(strewn(coordinate, 1.2F));
  NearestSurfels nearest(map, samples.size());
  int changed = 0;
  for (int iteration = 0; iteration < 60; ++iteration) {
    const float length = 0.3F * std::pow(0.85F, static_cast<float>(iteration));  // m
    for (std::size_t i = 0; i < samples.size(); ++i) {
      const std::int32_t before = map.nearest(samples[i]).surfel;
      samples[i] += strewn(step, length);
      const std::int32_t expected = map.nearest(samples[i]).surfel;
      EXPECT_EQ(nearest.of(i, samples[i]), expected);
      changed += static_cast<int>(before != expected);
    }
  }
  EXPECT_GT(changed, 1000);
}

TEST(RegisterNearby, DoesNotTakeTheCeilingBelowForTheFloor) {
  const SurfelCloud floor = corridor(true);
  SurfelCloud below = floor;
  for (Eigen::Vector3f& normal : below.normals) normal = -normal;
  const SurfelMap reference(floor, voxel);
  const Rigid3 guess{Eigen::Quaterniond::Identity(), Eigen::Vector3d(0.05, 0.05, 0.1)};
  EXPECT_TRUE(register_nearby(floor, reference, guess, 900).converged);
  const SurfelAlignment found = register_nearby(below, reference, guess, 900);
  EXPECT_FALSE(found.converged);
  EXPECT_EQ(found.pairs, 0);
}

TEST(RegisterPoints, FindsAnyMotionInARoom) {
  std::mt19937 random(1);
  const std::vector<Eigen::Vector3f> room = room_cloud(random, 6000);
  SurfelCloud planes;
  for (const Eigen::Vector3f& p : room) {
    planes.means.push_back(p);
    planes.normals.push_back(std::abs(std::abs(p.z()) - 2.0F) < 1e-4F ? Eigen::Vector3f::UnitZ()
                             : std::abs(std::abs(p.y()) - 7.0F) < 1e-4F || p.y() == 1.5F
                                 ? Eigen::Vector3f::UnitY()
                                 : Eigen::Vector3f::UnitX());
  }
  const SurfelMap reference(planes, voxel);
  Twist twist;
  twist << 0.12, -0.1, 0.05, 0.01, -0.012, 0.015;
  const Rigid3 truth = exp(twist);
  const std::vector<Eigen::Vector3f> seen = moved(truth.inverse(), room_cloud(random, 1500));
  // A guess that is hardly believed leaves it to the planes.
  const SurfelAlignment found = register_points(seen, reference, Rigid3{}, {10.0, 10.0});
  EXPECT_TRUE(found.converged);
  EXPECT_THAT(found.reference_from_query, PoseNear(truth, 0.005, 0.0005));
}

TEST(RegisterPoints, LeaveAnOpenDirectionToTheGuess) {
  const SurfelMap reference(corridor(false), voxel);
  std::vector<Eigen::Vector3f> seen;
  for (const Eigen::Vector3f& p : corridor(false).means) {
    if (std::abs(p.x()) < 8.0F) seen.push_back(p + Eigen::Vector3f(0.0F, 0.1F, 0.0F));
  }
  const Rigid3 guess{Eigen::Quaterniond::Identity(), Eigen::Vector3d(0.3, 0.0, 0.0)};
  const SurfelAlignment found = register_points(seen, reference, guess, sigmas);
  EXPECT_TRUE(found.converged);
  EXPECT_NEAR(found.reference_from_query.translation.x(), 0.3, 1e-6) << "no plane faces x";
  EXPECT_NEAR(found.reference_from_query.translation.y(), -0.1, 0.005);
}

TEST(InformationOfAnAlignment, SaysNothingAlongABareCorridorAndMuchAcross) {
  for (const bool ends : {false, true}) {
    const SurfelMap reference(corridor(ends), voxel);
    const SurfelAlignment found =
        register_points(corridor(ends).means, reference, Rigid3{}, sigmas);
    ASSERT_TRUE(found.converged);
    const Eigen::Matrix<double, 6, 6> information = information_of(found);
    EXPECT_EQ(information, information.transpose()) << "to the last bit";
    EXPECT_GT(information(1, 1), 1e4) << "centimetres across";
    EXPECT_GT(information(2, 2), 1e4);
    if (ends) {
      EXPECT_GT(information(0, 0), 1e4);
    } else {
      EXPECT_LT(information(0, 0), 1e-3) << "nothing along";
    }
  }
}

}  // namespace
}  // namespace kissmap
