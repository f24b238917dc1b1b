// SPDX-License-Identifier: MIT
// Loops of simulated tours against exact truth. One seed; KISSMAP_SEEDS=n for more.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <map>
#include <vector>

#include "kissmap/loop_closing/loop_closer.hpp"
#include "kissmap/loop_closing/loop_editor.hpp"
#include "kissmap/mapping/mapper.hpp"
#include "simulator/scenario.hpp"
#include "support/trajectory_error.hpp"

namespace kissmap {
namespace {

using simulator::Scenario;
using simulator::Simulator;

constexpr double revisited_overlap = 0.4;

std::uint64_t seeds() {
  const char* text = std::getenv("KISSMAP_SEEDS");
  return text == nullptr ? 1 : std::strtoull(text, nullptr, 10);
}

/// A tour mapped with loops closed, and the truth beside it.
struct Tour {
  std::vector<LocalMap> local_maps;
  std::vector<Rigid3> true_keyposes;
  std::vector<Closure> closures;
  double odometry_ate = 0.0;
  double ate = 0.0;
  double open_ate = 0.0;     ///< without any closure
  double by_hand_ate = 0.0;  ///< with one that was added by hand
};

Tour map_tour(const Scenario& scenario) {
  const Simulator simulator = simulator::make_simulator(scenario);
  ThreadPool pool;
  Mapper mapper({}, {}, pool);
  Tour tour;
  LoopCloser loops({}, LocalMapOptions{}.voxel_size, [&tour](std::uint32_t id) {
    return tour.local_maps[id].surfels;
  });
  std::vector<ScanPlace> places;
  std::vector<std::int64_t> stamps;
  Positions odometry;
  Positions truth;
  const auto close = [&](const std::optional<LocalMap>& local_map) {
    if (!local_map) return;
    tour.local_maps.push_back(*local_map);
    loops.add(*local_map);
  };
  for (std::size_t i = 0; i < simulator.scan_count(); ++i) {
    const MapperStep step = mapper.add(simulator.scan(i));
    const auto& mapped = std::get<MappedScan>(step.scan);
    const Rigid3 true_pose = simulator.map_from_lidar(mapped.pose_stamp_ns);
    if (i == 0) tour.true_keyposes.push_back(true_pose);
    if (step.closed) tour.true_keyposes.push_back(true_pose);
    places.push_back({mapped.local_map_id, mapped.local_map_from_lidar});
    stamps.push_back(mapped.pose_stamp_ns);
    odometry[mapped.pose_stamp_ns] = mapped.map_from_lidar.translation;
    truth[mapped.pose_stamp_ns] = true_pose.translation;
    close(step.closed);
  }
  close(mapper.finish());
  loops.look_again();
  const auto ate = [&](const LoopCorrection& correction) {
    Positions corrected;
    for (std::size_t i = 0; i < stamps.size(); ++i) {
      corrected[stamps[i]] = correction.map_from_lidar[i].translation;
    }
    return trajectory_error(corrected, truth).ate;
  };
  const LoopEvidence evidence = loops.evidence();
  const LoopCorrection correction = correct_loops(places, evidence);
  tour.closures = correction.closures;
  tour.odometry_ate = trajectory_error(odometry, truth).ate;
  tour.ate = ate(correction);

  // As if no loop had been found, but for one that is then closed by hand.
  LoopEvidence open = evidence;
  open.closures.clear();
  tour.open_ate = ate(correct_loops(places, open));
  LoopEditor editor(open, places, {}, LocalMapOptions{}.voxel_size, [&tour](std::uint32_t id) {
    return tour.local_maps[id].surfels;
  });
  const auto best = std::ranges::max_element(
      tour.closures, {}, [](const Closure& c) { return enters_graph(c) ? c.overlap : 0.0; });
  editor.join(best->reference_id, best->query_id);
  tour.by_hand_ate = ate(editor.correction());
  return tour;
}

/// Ids of local maps that truly show, by the overlap of 40 %, what one not among the three before
/// them showed.
std::vector<std::uint32_t> revisits(const Tour& tour) {
  std::vector<std::uint32_t> ids;
  const double voxel_size = LocalMapOptions{}.voxel_size;
  for (std::uint32_t query = 4; query < tour.local_maps.size(); ++query) {
    for (std::uint32_t reference = 0; reference + 4 <= query; ++reference) {
      const Rigid3 reference_from_query =
          tour.true_keyposes[reference].inverse() * tour.true_keyposes[query];
      const SurfelMap map(tour.local_maps[reference].surfels, voxel_size);
      if (overlap(tour.local_maps[query].surfels, map, reference_from_query) < revisited_overlap) {
        continue;
      }
      ids.push_back(query);
      break;
    }
  }
  return ids;
}

class LoopTours : public testing::TestWithParam<Scenario> {};

TEST_P(LoopTours, AllClosuresAreTrueMostRevisitsAreFoundAndDriftIsGone) {
  for (std::uint64_t seed = 1; seed <= seeds(); ++seed) {
    Scenario scenario = GetParam();
    scenario.seed = seed;
    const Tour tour = map_tour(scenario);
    std::vector<std::uint32_t> found;
    for (const Closure& closure : tour.closures) {
      if (closure.verdict != ClosureVerdict::accepted) continue;
      found.push_back(closure.query_id);
      // Where the two meet; keyposes are off by what each local map is bent.
      const Rigid3 truth =
          tour.true_keyposes[closure.reference_id].inverse() * tour.true_keyposes[closure.query_id];
      const Eigen::Vector3d center = closure.center_in_query;
      EXPECT_LT((truth * center - closure.reference_from_query * center).norm(), 1.0)
          << closure.query_id << " to " << closure.reference_id << ", seed " << seed;
      EXPECT_LT((truth.inverse() * closure.reference_from_query).angle(), 0.1)
          << closure.query_id << " to " << closure.reference_id << ", seed " << seed;
    }
    const std::vector<std::uint32_t> revisited = revisits(tour);
    EXPECT_GE(revisited.size(), 3U) << "the tour meets its own way";
    const auto missed = std::ranges::count_if(revisited, [&found](std::uint32_t id) {
      return std::ranges::find(found, id) == found.end();
    });
    EXPECT_LE(10 * missed, static_cast<std::ptrdiff_t>(revisited.size())) << "seed " << seed;
    EXPECT_LT(tour.ate, std::max(0.15, tour.odometry_ate / 3.0)) << "seed " << seed;
    EXPECT_LT(tour.by_hand_ate, tour.open_ate) << "seed " << seed;
    RecordProperty("ate_m_seed_" + std::to_string(seed), std::to_string(tour.ate));
  }
}

Scenario town(const char* motion) {
  Scenario scenario;
  scenario.sensor = "spinning16";
  scenario.motion = motion;
  scenario.columns = 600;
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
