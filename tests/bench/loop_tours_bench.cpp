// SPDX-License-Identifier: MIT
// Loops found on simulated tours, against exact truth: a line for each seed.
//   loop_tours_bench WORLD SENSOR MOTION COLUMNS FIRST_SEED LAST_SEED [SPLIT]
// COLUMNS 0: the sensor's own. SPLIT: local maps end at that displacement [m] instead of by range.
// All closures count as false that are 2 m or 10 degrees off. What odometry turned by wrongly is
// that within two seconds, at most.
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <numbers>

#include "simulator/scenario.hpp"
#include "support/loop_tour.hpp"

namespace kissmap {
namespace {

constexpr double false_metres = 2.0;
constexpr double false_degrees = 10.0;
constexpr double degrees_per_radian = 180.0 / std::numbers::pi;

void measure(const simulator::Scenario& scenario, const SplittingRule& rule) {
  const simulator::Simulator simulator = simulator::make_simulator(scenario);
  LoopTour tour(rule);
  for (std::size_t i = 0; i < simulator.scan_count(); ++i) tour.add(simulator.scan(i), simulator);
  tour.finish();
  double farthest = 0.0;
  double most_turned = 0.0;
  int wrong = 0;
  const std::vector<Closure> accepted = tour.accepted();
  for (const Closure& closure : accepted) {
    const double metres = tour.off_by(closure);
    const double degrees = degrees_per_radian * tour.turned_by(closure);
    farthest = std::max(farthest, metres);
    most_turned = std::max(most_turned, degrees);
    if (metres > false_metres || degrees > false_degrees) ++wrong;
  }
  const std::vector<std::uint32_t> revisits = tour.revisits();
  std::printf(
      "%s %s %s seed %d: %zu scans, %zu maps, revisited %zu, found %zu, closures %zu, false %d "
      "(farthest %.2f m, %.1f deg), odometry turned by %.1f deg, ATE %.3f -> %.3f m\n",
      scenario.world.c_str(),
      scenario.sensor.c_str(),
      scenario.motion.c_str(),
      static_cast<int>(scenario.seed),
      simulator.scan_count(),
      tour.local_maps().size(),
      revisits.size(),
      tour.found(revisits),
      accepted.size(),
      wrong,
      farthest,
      most_turned,
      degrees_per_radian * tour.odometry_most_turned(),
      tour.odometry_ate(),
      tour.ate(tour.correction()));
  std::fflush(stdout);
}

}  // namespace
}  // namespace kissmap

int main(int argc, char** argv) {
  if (argc != 7 && argc != 8) {
    std::fputs("loop_tours_bench WORLD SENSOR MOTION COLUMNS FIRST_SEED LAST_SEED [SPLIT]\n",
               stderr);
    return 2;
  }
  kissmap::SplittingRule rule;
  if (argc == 8) rule = kissmap::split_by_displacement(std::atof(argv[7]));
  kissmap::simulator::Scenario scenario;
  scenario.world = argv[1];
  scenario.sensor = argv[2];
  scenario.motion = argv[3];
  scenario.columns = std::atoi(argv[4]);
  for (int seed = std::atoi(argv[5]); seed <= std::atoi(argv[6]); ++seed) {
    scenario.seed = static_cast<std::uint64_t>(seed);
    kissmap::measure(scenario, rule);
  }
  return 0;
}
