// SPDX-License-Identifier: MIT
// Loops of simulated tours against exact truth. One seed; KISSMAP_SEEDS=n for more.
#include <gtest/gtest.h>

#include <algorithm>

#include "end_to_end/loop_expectations.hpp"
#include "kissmap/loop_closing/loop_editor.hpp"
#include "simulator/scenario.hpp"

namespace kissmap {
namespace {

using simulator::Scenario;
using simulator::Simulator;

LoopTour& map_tour(const Scenario& scenario, LoopTour& tour) {
  const Simulator simulator = simulator::make_simulator(scenario);
  for (std::size_t i = 0; i < simulator.scan_count(); ++i) tour.add(simulator.scan(i), simulator);
  tour.finish();
  return tour;
}

/// How far the query lies from where a closure measured it, where the two meet [m].
double off_by(const LoopCorrection& correction, const Closure& closure) {
  const auto& keyposes = correction.map_from_local_map;
  const Rigid3 found = keyposes[closure.reference_id].inverse() * keyposes[closure.query_id];
  return (closure.reference_from_query * closure.center_in_query - found * closure.center_in_query)
      .norm();
}

/// As if no loop had been found, but for the best one, which is then closed by hand. That closures
/// are true is asked elsewhere.
void expect_a_closure_by_hand_to_close(const LoopTour& tour) {
  LoopEvidence open = tour.evidence();
  const auto best = *std::ranges::max_element(
      open.closures, {}, [](const Closure& c) { return enters_graph(c) ? c.overlap : 0.0; });
  open.closures.clear();
  LoopEditor editor(
      open, tour.places(), {}, LocalMapOptions{}.voxel_size, [&tour](std::uint32_t id) {
        return tour.local_maps()[id].surfels;
      });
  editor.join(best.reference_id, best.query_id);
  // Surfaces fitted to each other may have closed the loop to a centimetre already: then a closure,
  // which is as accurate as its registration, leaves it closed.
  constexpr double closed = 0.1;  // m
  const double before = off_by(correct_loops(tour.places(), open), best);
  EXPECT_LT(off_by(editor.correction(), best), std::max(before, closed));
}

/// A third of the odometry's, or 0.15 m.
void expect_little_drift(const LoopTour& tour) {
  EXPECT_LT(tour.ate(tour.correction()), std::max(0.15, tour.odometry_ate() / 3.0));
}

template <class Judge>
void for_each_seed(Scenario scenario, const Judge& judge) {
  for (scenario.seed = 1; scenario.seed <= seeds(); ++scenario.seed) {
    SCOPED_TRACE("seed " + std::to_string(scenario.seed));
    LoopTour tour;
    map_tour(scenario, tour);
    judge(tour, scenario.seed);
  }
}

class LoopTours : public testing::TestWithParam<Scenario> {};

TEST_P(LoopTours, AllClosuresAreTrueMostRevisitsAreFoundAndDriftIsGone) {
  for_each_seed(GetParam(), [](const LoopTour& tour, std::uint64_t seed) {
    expect_true_closures(tour, 1.0);
    expect_each_pair_once(tour);
    const std::vector<std::uint32_t> revisits = tour.revisits();
    EXPECT_GE(revisits.size(), 3U) << "the tour meets its own way";
    expect_most_found(tour, revisits);
    expect_little_drift(tour);
    expect_a_closure_by_hand_to_close(tour);
    testing::Test::RecordProperty("ate_m_seed_" + std::to_string(seed),
                                  std::to_string(tour.ate(tour.correction())));
  });
}

Scenario narrow_view(const char* sensor) {
  Scenario scenario;
  scenario.sensor = sensor;
  scenario.motion = "car-opposite";
  return scenario;
}

class NarrowViews : public testing::TestWithParam<Scenario> {};

// Two visits share too little for a closure, but surfaces which both saw tie them to each other.
TEST_P(NarrowViews, FromTheOtherSideCloseNoFalseLoopAndLoseTheirDrift) {
  for_each_seed(GetParam(), [](const LoopTour& tour, std::uint64_t) {
    constexpr double lost = 0.15;  // rad within two seconds: no odometry to judge loops by
    expect_true_closures(tour, 1.5);
    if (tour.odometry_most_turned() < lost) expect_little_drift(tour);
  });
}

INSTANTIATE_TEST_SUITE_P(OppositeDirection,
                         NarrowViews,
                         testing::Values(narrow_view("rosette"), narrow_view("raster")),
                         [](const auto& tour) { return tour.param.sensor; });

TEST(LoopsInTheOffice, AreFound) {
  Scenario office;
  office.world = "office";
  office.sensor = "spinning16";
  office.motion = "robot";
  for_each_seed(office, [](const LoopTour& tour, std::uint64_t) {
    // The robot starts in a corridor that is alike everywhere: its first metres drift most.
    expect_true_closures(tour, 2.0);
    const std::vector<std::uint32_t> revisits = tour.revisits();
    EXPECT_GE(revisits.size(), 1U);
    expect_most_found(tour, revisits);
    expect_little_drift(tour);
  });
}

Scenario town(const char* motion) {
  Scenario scenario;
  scenario.sensor = "spinning16";
  scenario.motion = motion;
  // One seed in every build has to be quick; what is asked of ten is asked of the whole sensor.
  scenario.columns = seeds() > 1 ? 0 : 600;
  return scenario;
}

INSTANTIATE_TEST_SUITE_P(Town,
                         LoopTours,
                         testing::Values(town("car"), town("car-opposite")),
                         [](const auto& tour) {
                           return tour.index == 0 ? "same_direction" : "opposite_direction";
                         });

}  // namespace
}  // namespace kissmap
