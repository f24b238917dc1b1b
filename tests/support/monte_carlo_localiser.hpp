// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <vector>

#include "simulator/random.hpp"
#include "support/occupancy_plan.hpp"

namespace kissmap {

struct LocaliserOptions {
  int particles = 10'000;        ///< at the start, and as long as it does not know where it is
  int least_particles = 2000;    ///< once it does
  int beams = 60;                ///< of each scan that are looked at
  double hit_deviation = 0.2;    ///< m, between the end of a beam and what the map shows
  double first_deviation = 1.0;  ///< m, of the first scans: particles lie far apart
  int settling = 100;            ///< scans during which the deviation shrinks
  double miss_share = 0.1;       ///< likelihood of beams that end far from anything in the map
  double trust = 0.06;      ///< weight of a beam's log likelihood; neighbours are not independent
  double max_range = 20.0;  ///< m; beams without a return say nothing
};

/// Where am I in this map? Monte Carlo localisation with particles all over free space, likelihood
/// field and noisy odometry (Thrun, Burgard, Fox, Probabilistic Robotics, tables 5.6, 6.3, 8.2),
/// their number after Fox (KLD-sampling, IJRR 2003). For judging maps as robots do: it knows only
/// the map, the scans and the wheels. The same answer for the same seed; one thread.
class MonteCarloLocaliser {
 public:
  /// Throws Error(usage) for a map without free or without occupied cells.
  MonteCarloLocaliser(const OccupancyPlan& plan,
                      const LocaliserOptions& options,
                      std::uint64_t seed);

  /// The robot moved by `before_from_now`, by its odometry, and then measured `ranges`: beam k
  /// looks at -pi + 2 pi k / n from straight ahead, 0 means no return.
  void update(const Pose2& before_from_now, const std::vector<float>& ranges);

  /// Mean of the particles around the likeliest.
  Pose2 map_from_robot() const;

  std::size_t particle_count() const { return particles_.size(); }

 private:
  struct Particle {
    Pose2 pose;
    double weight = 1.0;
  };
  void scatter();
  double deviation() const;
  void make_field();
  void move(const Pose2& before_from_now);
  std::vector<Eigen::Vector2f> beam_ends(const std::vector<float>& ranges) const;
  double log_likelihood(const Pose2& pose, const std::vector<Eigen::Vector2f>& ends) const;
  void weigh(const std::vector<float>& ranges);
  void resample();
  std::size_t needed() const;
  std::size_t likeliest() const;

  const OccupancyPlan plan_;
  LocaliserOptions options_;
  simulator::Random random_;
  int scans_ = 0;
  std::vector<double> distance_;       ///< m, from each cell to the nearest occupied one
  std::vector<float> log_likelihood_;  ///< of a beam that ends in a cell
  float log_outside_ = 0.0F;           ///< of a beam that ends beyond the map
  std::vector<Particle> particles_;
};

}  // namespace kissmap
