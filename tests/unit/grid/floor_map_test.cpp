// SPDX-License-Identifier: MIT
// Floors of places made of known surfaces, seen from a sensor carried through them.
#include "kissmap/grid/floor_map.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <random>

namespace kissmap {
namespace {

constexpr double cell_size = 0.25;
constexpr double carried = 1.2;  // m above the floor
constexpr double noise = 0.015;  // m

using Heights = std::function<double(double x, double y)>;

/// A scan that sees the surface over a disc around the sensor; points in the lidar frame.
class Place {
 public:
  void see(const Eigen::Vector3d& sensor, const Heights& surface, double radius = 8.0) {
    PlacedScan scan;
    scan.map_from_lidar.translation = sensor;
    std::uniform_real_distribution<double> aside(-radius, radius);
    std::normal_distribution<double> error(0.0, noise);
    for (int i = 0; i < 4000; ++i) {
      const Eigen::Vector2d at = sensor.head<2>() + Eigen::Vector2d(aside(random_), aside(random_));
      const double z = surface(at.x(), at.y()) + error(random_);
      if (std::isnan(z)) continue;
      scan.points.emplace_back((Eigen::Vector3d(at.x(), at.y(), z) - sensor).cast<float>());
    }
    scan.origins.assign(scan.points.size(), Eigen::Vector3f::Zero());
    sampler_.add(scan, Rigid3{});
  }

  /// Walks a path, `step` apart, over a floor, seeing `surface`.
  SensorPath walk(const std::vector<Eigen::Vector2d>& corners,
                  const Heights& floor,
                  const Heights& surface) {
    SensorPath path;
    for (std::size_t i = 0; i + 1 < corners.size(); ++i) {
      const double length = (corners[i + 1] - corners[i]).norm();
      for (double s = 0.0; s < length; s += 0.5) {
        const Eigen::Vector2d at = corners[i] + s / length * (corners[i + 1] - corners[i]);
        path.emplace_back(at.x(), at.y(), floor(at.x(), at.y()) + carried);
        see(path.back(), surface);
      }
    }
    return path;
  }

  FloorMap floor(const SensorPath& path) const {
    const std::vector<FloorSample> samples = sampler_.samples();
    return floor_under(path, samples, cell_size, sensor_height(path, samples, cell_size));
  }
  std::vector<FloorSample> samples() const { return sampler_.samples(); }

 private:
  std::mt19937_64 random_{3};
  FloorSampler sampler_{cell_size, 30.0};
};

double largest_error(const FloorMap& map, const Heights& truth, const Eigen::AlignedBox2d& area) {
  double worst = 0.0;
  for (double x = area.min().x(); x < area.max().x(); x += 0.13) {
    for (double y = area.min().y(); y < area.max().y(); y += 0.17) {
      worst = std::max(worst, std::abs(map.height(x, y) - truth(x, y)));
    }
  }
  return worst;
}

TEST(SensorHeight, IsThatOverTheFloorWhateverElseIsSeen) {
  Place place;
  const Heights floor = [](double, double) { return 0.3; };
  const Heights surface = [](double x, double y) {
    return std::fmod(std::abs(x + y), 2.0) < 0.4 ? 1.05 : 0.3;
  };
  const SensorPath path = place.walk({{0.0, 0.0}, {10.0, 0.0}}, floor, surface);
  EXPECT_NEAR(sensor_height(path, place.samples(), cell_size), carried, 0.03);
  EXPECT_EQ(sensor_height(path, {}, cell_size), 0.0);
}

TEST(FloorMap, FollowsHillsAndRamps) {
  Place place;
  const double ramp = std::tan(10.0 * M_PI / 180.0);
  const Heights floor = [ramp](double x, double) { return ramp * std::clamp(x - 10.0, 0.0, 15.0); };
  const SensorPath path = place.walk({{0.0, 0.0}, {40.0, 0.0}}, floor, floor);
  // The foot of the ramp is rounded by the smoothing: half a cell of it, 0.75 m of the median.
  EXPECT_LT(
      largest_error(place.floor(path), floor, {Eigen::Vector2d(-5, -6), Eigen::Vector2d(42, 6)}),
      0.05);
}

TEST(FloorMap, TakesNoDeskNorBoxForFloorButAWidePavement) {
  Place place;
  const Heights floor = [](double, double y) { return y > 3.0 ? 0.12 : 0.0; };
  const Heights surface = [&floor](double x, double y) {
    const double u = std::fmod(x + 100.0, 4.0);
    if (u < 1.6 && y > -3.0 && y < -2.2) return 0.75;          // desks
    if (u > 2.0 && u < 2.3 && std::abs(y) < 0.3) return 0.15;  // parcels
    return floor(x, y);
  };
  const SensorPath path = place.walk({{0.0, 0.0}, {20.0, 0.0}}, floor, surface);
  const FloorMap map = place.floor(path);
  const Heights level = [](double, double) { return 0.0; };
  EXPECT_LT(largest_error(map, level, {Eigen::Vector2d(0, -6), Eigen::Vector2d(20, 2.2)}), 0.04);
  const Heights pavement = [](double, double) { return 0.12; };
  EXPECT_LT(largest_error(map, pavement, {Eigen::Vector2d(0, 3.8), Eigen::Vector2d(20, 6.0)}),
            0.04);
}

TEST(FloorMap, FillsWhatIsNotSeenFromAround) {
  Place place;
  const Heights slope = [](double x, double) { return 0.1 * x; };
  const Heights surface = [&slope](double x, double y) {
    return x > 8.0 && x < 10.0 && y > 2.0 && y < 4.0 ? std::nan("") : slope(x, y);
  };
  const SensorPath path = place.walk({{0.0, 0.0}, {20.0, 0.0}}, slope, surface);
  EXPECT_LT(
      largest_error(place.floor(path), slope, {Eigen::Vector2d(0, -6), Eigen::Vector2d(20, 6)}),
      0.08);
}

TEST(FloorMap, WithoutFloorIsLevel) {
  const FloorMap map = floor_under({{0.0, 0.0, 1.0}}, {}, cell_size, 1.0);
  EXPECT_EQ(map.height(3.0, -7.0), 0.0);
  EXPECT_EQ(map.lowest(), 0.0);
  EXPECT_EQ(map.highest(), 0.0);
}

TEST(FloorMap, IsSeenWhereItWasReachedAndTwoMetresBeside) {
  Place place;
  const Heights level = [](double, double) { return 0.0; };
  const Heights broken = [](double, double y) { return y > 4.0 && y < 7.5 ? std::nan("") : 0.0; };
  const FloorMap map = place.floor(place.walk({{0.0, 0.0}, {10.0, 0.0}}, level, broken));
  EXPECT_TRUE(map.is_seen(5.0, 0.0));
  EXPECT_TRUE(map.is_seen(5.0, 5.5));
  EXPECT_FALSE(map.is_seen(5.0, 6.5));
  EXPECT_FALSE(map.is_seen(5.0, 7.8)) << "a surface beyond a gap may be another floor";
  EXPECT_FALSE(map.is_seen(5.0, 100.0));
  EXPECT_TRUE(FloorMap().is_seen(5.0, 100.0)) << "heights are not measured from a floor";
}

TEST(FloorMap, OfEachStoreyIsItsOwn) {
  Place place;
  // Up along y = 0 over a ramp from x = 10 to 28 to a gallery 3 m up, whose floor lies over the
  // lower one for y > 4 from x = 0 on.
  const double ramp = 3.0 / 18.0;
  const Heights up = [ramp](double x, double) { return ramp * std::clamp(x - 10.0, 0.0, 18.0); };
  const Heights gallery = [](double, double) { return 3.0; };
  const Heights lower = [&up](double x, double y) { return y > 4.0 ? 0.0 : up(x, y); };
  const SensorPath first = place.walk({{0.0, 0.0}, {32.0, 0.0}}, up, lower);
  const Heights upper = [&up](double x, double y) { return y > 4.0 || x > 28.0 ? 3.0 : up(x, y); };
  const SensorPath second = place.walk({{32.0, 0.0}, {32.0, 8.0}, {0.0, 8.0}}, gallery, upper);
  const std::vector<FloorSample> samples = place.samples();
  const double height = sensor_height(first, samples, cell_size);
  const FloorMap below =
      floor_under({first.begin(), first.begin() + 30}, samples, cell_size, height);
  const FloorMap above = floor_under(second, samples, cell_size, height);
  const Heights level = [](double, double) { return 0.0; };
  EXPECT_LT(largest_error(below, level, {Eigen::Vector2d(0, 4.5), Eigen::Vector2d(20, 7.0)}), 0.05);
  EXPECT_LT(largest_error(above, gallery, {Eigen::Vector2d(2, 4.5), Eigen::Vector2d(30, 12.0)}),
            0.05);
}

}  // namespace
}  // namespace kissmap
