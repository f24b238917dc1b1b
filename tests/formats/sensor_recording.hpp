// SPDX-License-Identifier: MIT
// Decoded sweeps against the cloud that another program decoded from the same packets.
#pragma once

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <map>
#include <numbers>
#include <tuple>
#include <vector>

#include "formats/packet_bag.hpp"
#include "formats/sensors/packet_decoder.hpp"

namespace kissmap::test {

inline std::vector<Scan> take_all(PacketDecoder& decoder) {
  std::vector<Scan> scans;
  while (std::optional<Scan> scan = decoder.take()) {
    EXPECT_NO_THROW(require_consistent(*scan));
    scans.push_back(std::move(*scan));
  }
  return scans;
}

inline std::vector<Eigen::Vector3d> points_of(const std::vector<Scan>& scans) {
  std::vector<Eigen::Vector3d> points;
  for (const Scan& scan : scans) {
    for (const Eigen::Vector3f& point : scan.points) points.push_back(point.cast<double>());
  }
  return points;
}

/// Finds for points of one cloud the nearest of another, within a reach that is given once.
class NearestPoints {
 public:
  NearestPoints(const std::vector<Eigen::Vector3d>& points, double reach) : reach_(reach) {
    for (const Eigen::Vector3d& point : points) cells_[cell(point)].push_back(point);
  }

  /// Share of `points` that have one within the reach.
  double share(const std::vector<Eigen::Vector3d>& points) const {
    const auto near = std::count_if(
        points.begin(), points.end(), [this](const Eigen::Vector3d& p) { return has_near(p); });
    return static_cast<double>(near) / static_cast<double>(points.size());
  }

  bool has_near(const Eigen::Vector3d& point) const {
    const auto [x, y, z] = cell(point);
    for (int i = 0; i < 27; ++i) {
      const auto found = cells_.find({x + i % 3 - 1, y + i / 3 % 3 - 1, z + i / 9 - 1});
      if (found == cells_.end()) continue;
      for (const Eigen::Vector3d& other : found->second) {
        if ((other - point).norm() <= reach_) return true;
      }
    }
    return false;
  }

 private:
  using Cell = std::tuple<long, long, long>;
  Cell cell(const Eigen::Vector3d& p) const {
    return {std::lround(p.x() / reach_), std::lround(p.y() / reach_), std::lround(p.z() / reach_)};
  }
  double reach_;
  std::map<Cell, std::vector<Eigen::Vector3d>> cells_;
};

/// Of any `length` points in a row, the highest share that the other cloud has too. Programs cut
/// turns at different directions: this finds the turn that the other cloud is of.
inline double best_run(const NearestPoints& cloud,
                       const std::vector<Eigen::Vector3d>& points,
                       std::size_t length) {
  std::vector<std::size_t> found{0};
  for (const Eigen::Vector3d& point : points)
    found.push_back(found.back() + (cloud.has_near(point) ? 1 : 0));
  std::size_t best = 0;
  for (std::size_t i = length; i < found.size(); ++i)
    best = std::max(best, found[i] - found[i - length]);
  return static_cast<double>(best) / static_cast<double>(length);
}

/// Pairs shots by distance and elevation, which the azimuth has no part in.
class SameShots {
 public:
  explicit SameShots(const std::vector<Eigen::Vector3d>& points) {
    for (const Eigen::Vector3d& point : points) shots_[key(point)].push_back(azimuth_deg(point));
  }

  /// Least difference in azimuth to a shot of the same laser and distance [deg]; 360 without one.
  double turned_deg(const Eigen::Vector3d& point) const {
    double least = 360.0;
    const auto [distance, elevation] = key(point);
    for (long i = 0; i < 9; ++i) {
      const auto found = shots_.find({distance + i % 3 - 1, elevation + i / 3 - 1});
      if (found == shots_.end()) continue;
      for (const double other : found->second) {
        least = std::min(least, std::abs(std::remainder(other - azimuth_deg(point), 360.0)));
      }
    }
    return least;
  }

 private:
  static constexpr double deg_per_rad = 180.0 / std::numbers::pi;
  static constexpr double distance_bin = 0.001;  // m, half the finest unit
  static constexpr double elevation_bin = 0.03;  // deg, well below what is between lasers
  static std::pair<long, long> key(const Eigen::Vector3d& p) {
    const double elevation = std::asin(p.z() / p.norm()) * deg_per_rad;
    return {std::lround(p.norm() / distance_bin), std::lround(elevation / elevation_bin)};
  }
  static double azimuth_deg(const Eigen::Vector3d& p) {
    return std::atan2(p.y(), p.x()) * deg_per_rad;
  }

  std::map<std::pair<long, long>, std::vector<double>> shots_;
};

/// Folder of recorded packets by maker; skips the test where there is none.
class PacketRecordings : public testing::Test {
 protected:
  void SetUp() override {
    const char* folder = std::getenv("KISSMAP_TEST_DATA");
    if (folder == nullptr) GTEST_SKIP() << "KISSMAP_TEST_DATA does not name the recordings";
    packets_ = std::filesystem::path(folder) / "packets";
  }
  std::filesystem::path packets_;
};

/// Sweeps that begin and end within the recording take the time of one turn at 10 Hz.
inline void expect_turns_of_a_tenth(const std::vector<Scan>& scans) {
  ASSERT_GE(scans.size(), 2U);
  for (std::size_t i = 0; i + 1 < scans.size(); ++i) {
    const auto span = time_span(scans[i]);
    ASSERT_TRUE(span);
    EXPECT_EQ(span->first, std::min(span->first, 0.0F));
    EXPECT_NEAR(span->last - span->first, 0.1, 0.001) << "sweep " << i;
  }
}

}  // namespace kissmap::test
