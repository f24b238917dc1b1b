// SPDX-License-Identifier: MIT
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "simulator/motion.hpp"
#include "simulator/world.hpp"

namespace kissmap::simulator {

struct TownOptions {
  int streets = 5;              ///< each way
  double min_spacing = 70.0;    ///< m between the middles of parallel streets
  double max_spacing = 88.0;    ///< m
  double lane_width = 3.2;      ///< m; one lane each way
  double parking_width = 2.0;   ///< m, on both sides
  double sidewalk_width = 3.2;  ///< m
  double outskirts = 45.0;      ///< m built beyond the outermost streets
  double park_share = 0.15;     ///< of the blocks
  int moving_cars = 14;         ///< only on lanes that no tour of tours.hpp uses
  int pedestrians = 60;
};

/// A crossing of street `i` of those running along y and street `j` of those running along x.
struct Crossing {
  int i = 0;
  int j = 0;
  friend bool operator==(const Crossing&, const Crossing&) = default;
};

/// Streets on an uneven grid, houses with setbacks, bays and gaps, courtyards, parks, trees,
/// fences, poles, parked and moving cars, pedestrians. Roads at z = 0, everything else on kerbs of
/// 0.12 m.
struct Town {
  World world;
  TownOptions options;
  std::vector<double> x_of_street;  ///< m, middles of the streets along y, ascending
  std::vector<double> y_of_street;  ///< m, middles of the streets along x

  /// Middle of the road to the middle of the lane, and to the kerb [m].
  double lane_offset() const { return 0.5 * options.lane_width; }
  double kerb_offset() const { return options.lane_width + options.parking_width; }
  Eigen::Vector3d middle(Crossing crossing) const;

  /// The way of a car on the right-hand lanes through these crossings, one straight after the next.
  std::vector<Eigen::Vector3d> lane_through(const std::vector<Crossing>& crossings) const;
};

/// The block whose courtyard can be walked through from south to north, along its middle.
inline constexpr Crossing courtyard_block{1, 1};

inline constexpr double kerb_height = 0.12;  ///< m

/// The same town for the same seed and options.
Town make_town(std::uint64_t seed, const TownOptions& options = {});

/// Lanes that no tour uses: room for so many moving cars.
int free_lane_count(const TownOptions& options);

/// The crossings of the car tours: a loop whose first part is driven again in the same direction,
/// or one whose first part is driven again in the opposite direction.
std::vector<Crossing> same_direction_route();
std::vector<Crossing> opposite_direction_route();

}  // namespace kissmap::simulator
