// SPDX-License-Identifier: MIT
// One validation of a candidate between local maps of 100 m of a simulated town, 64 x 1024 rays,
// each seen twice with noise of its own: registered from guesses near and far from the truth.
#include <benchmark/benchmark.h>

#include <algorithm>
#include <cmath>
#include <ctime>
#include <numbers>
#include <vector>

#include "kissmap/loop_closing/closure_validation.hpp"
#include "kissmap/mapping/mapper.hpp"
#include "simulator/scenario.hpp"

namespace kissmap {
namespace {

constexpr double voxel_size = 0.5;          // m
constexpr double local_map_length = 100.0;  // m
constexpr std::size_t wanted = 3;

/// The local maps of every second scan, from `first` on.
std::vector<SurfelCloud> drive(const simulator::Simulator& simulator, std::size_t first) {
  ThreadPool pool;
  Mapper mapper({}, {}, pool, split_by_displacement(local_map_length));
  std::vector<SurfelCloud> maps;
  for (std::size_t i = first; i < simulator.scan_count() && maps.size() < wanted; i += 2) {
    const MapperStep step = mapper.add(simulator.scan(i));
    if (step.closed) maps.push_back(step.closed->surfels);
  }
  return maps;
}

struct Drives {
  std::vector<SurfelCloud> even;
  std::vector<SurfelCloud> odd;
};

const Drives& drives() {
  static const Drives made = [] {
    const simulator::Simulator simulator = simulator::make_simulator({});
    return Drives{drive(simulator, 0), drive(simulator, 1)};
  }();
  return made;
}

Rigid3 guess_off_by(double metres, double degrees, int direction) {
  const double angle = 0.7 * direction;
  return {Eigen::Quaterniond(
              Eigen::AngleAxisd(degrees * std::numbers::pi / 180.0, Eigen::Vector3d::UnitZ())),
          Eigen::Vector3d(metres * std::cos(angle), metres * std::sin(angle), 0.1 * metres)};
}

double cpu_seconds() {
  timespec now{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

/// Arguments: local maps between query and reference, metres and degrees that the guess is off.
/// As in a run, the reference is hashed for each candidate.
void validation(benchmark::State& state) {
  const auto apart = static_cast<std::size_t>(state.range(0));
  drives();  // not part of what is timed
  int direction = 0;
  int accepted = 0;
  double longest = 0.0;
  for (auto _ : state) {
    const double begin = cpu_seconds();
    const SurfelReference reference(drives().even[0], voxel_size);
    const Closure closure = validate_closure(
        drives().odd[apart],
        reference,
        guess_off_by(
            static_cast<double>(state.range(1)), static_cast<double>(state.range(2)), direction++),
        {});
    accepted += closure.verdict == ClosureVerdict::accepted ? 1 : 0;
    longest = std::max(longest, cpu_seconds() - begin);
  }
  state.counters["longest_ms"] = 1e3 * longest;
  state.counters["accepted"] = static_cast<double>(accepted) / static_cast<double>(direction);
  state.counters["surfels"] = static_cast<double>(drives().odd[apart].size());
}
BENCHMARK(validation)
    ->Args({0, 1, 2})
    ->Args({0, 3, 5})
    ->Args({0, 10, 40})
    ->Args({0, 0, 180})
    ->Args({1, 0, 0})
    ->Args({2, 5, 90})
    ->Iterations(20)
    ->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace kissmap

BENCHMARK_MAIN();
