// SPDX-License-Identifier: MIT
// What moved is told from what stands, on simulated logs with 20 movers: by true poses, and by
// those the real binary finds.
#include "kissmap/occupancy/moved_returns.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <unordered_map>
#include <vector>

#include "kissmap/cloud/voxel.hpp"
#include "kissmap/formats/session.hpp"
#include "simulator/log_folder.hpp"
#include "simulator/scenario.hpp"
#include "support/program.hpp"
#include "support/temp_dir.hpp"

namespace kissmap {
namespace {

using simulator::ObjectClass;
using simulator::Simulator;

constexpr double voxel_size = 0.1;  // m

/// A scan in its true place, and what each of its points lies on.
struct TrueScan {
  PlacedScan placed;
  std::vector<ObjectClass> classes;
};

/// A scan where a session has it.
TrueScan session_scan(const Simulator& simulator, const Session& session, std::size_t place) {
  const SessionScan& scan = session.scans[place];
  simulator::LabelledScan labelled = simulator.labelled_scan(scan.log_index);
  const MappedScan* before = place == 0 ? nullptr : &session.scans[place - 1].mapped;
  return {place_scan(labelled.scan, before, scan.mapped, 0.0, 1e6), std::move(labelled.classes)};
}

TrueScan true_scan(const Simulator& simulator, std::size_t scan_idx) {
  simulator::LabelledScan labelled = simulator.labelled_scan(scan_idx);
  const auto placed_at = [&](std::size_t i) {
    MappedScan mapped;
    mapped.stamp_ns = labelled.scan.stamp_ns;
    mapped.pose_stamp_ns = simulator.stamp_ns(i) +
                           std::llround(1e9 * static_cast<double>(time_span(labelled.scan)->last));
    mapped.map_from_lidar = simulator.map_from_lidar(mapped.pose_stamp_ns);
    mapped.deskewed = true;
    return mapped;
  };
  const MappedScan before = placed_at(scan_idx - 1);
  TrueScan scan;
  scan.placed = place_scan(labelled.scan, &before, placed_at(scan_idx), 0.0, 1e6);
  scan.classes = std::move(labelled.classes);
  return scan;
}

/// Indices of voxels as the tested program counts them.
struct Index {
  std::array<std::int32_t, 3> at;
  VoxelKey key() const { return voxel_key({at[0], at[1], at[2]}); }
};

Index index_of(const Eigen::Vector3d& place) {
  const Eigen::Vector3d floor = (place / voxel_size).array().floor();
  return {{static_cast<std::int32_t>(floor.x()),
           static_cast<std::int32_t>(floor.y()),
           static_cast<std::int32_t>(floor.z())}};
}

/// Calls visit for the voxels between two places, without that of the second (Amanatides and Woo).
template <class Visit>
void traverse(const Eigen::Vector3d& from, const Eigen::Vector3d& to, Visit&& visit) {
  Index index = index_of(from);
  const Index last = index_of(to);
  std::array<double, 3> next{};
  std::array<double, 3> step{};
  int steps = 0;
  for (int a = 0; a < 3; ++a) {
    const auto i = static_cast<std::size_t>(a);
    const double way = to[a] - from[a];
    const double face = voxel_size * (index.at[i] + (way > 0.0 ? 1 : 0));
    next[i] = way == 0.0 ? 2.0 : (face - from[a]) / way;
    step[i] = way == 0.0 ? 2.0 : voxel_size / std::abs(way);
    steps += std::abs(last.at[i] - index.at[i]);
  }
  for (; steps > 0; --steps) {
    visit(index);
    const std::size_t a =
        next[0] < next[1] ? (next[0] < next[2] ? 0 : 2) : (next[1] < next[2] ? 1 : 2);
    index.at[a] += to[static_cast<int>(a)] > from[static_cast<int>(a)] ? 1 : -1;
    next[a] += step[a];
  }
}

struct TruthOfVoxel {
  std::uint32_t moving = 0;  ///< returns
  std::uint32_t standing = 0;
  std::uint32_t classes = 0;  ///< bit k: a return of class k
  std::uint32_t last_hit = 0;
  bool crossed = false;
};

/// A log seen twice: by the program under test, and by an oracle that knows the classes.
class MoverTrial {
 public:
  MoverTrial(const simulator::Scenario& scenario,
             std::size_t first,
             std::size_t every,
             std::size_t count,
             const std::filesystem::path& session = {})
      : simulator_(make_simulator(scenario)) {
    if (!session.empty()) session_ = read_session(session);
    for (std::size_t i = first; i < simulator_.scan_count() && scans_.size() < count; i += every) {
      scans_.push_back(i);
    }
    for (const std::size_t i : scans_) gather(scan_at(i));
    for (const std::size_t i : scans_) cast(scan_at(i));
    found_.decide(pool_);
  }

  /// Shares of mover voxels crossed by a ray of a scan without a return in them, and of voxels of a
  /// class or, without one, of all that stand.
  double removed_movers() const {
    return share([](const TruthOfVoxel& v) { return v.moving >= v.standing && v.crossed; });
  }
  double removed_static(std::optional<ObjectClass> of = std::nullopt) const {
    const std::uint32_t wanted = of ? 1U << static_cast<unsigned>(*of) : ~0U;
    return share([wanted](const TruthOfVoxel& v) {
      return v.standing > v.moving && (v.classes & wanted) != 0;
    });
  }

  void expect_what_moved_and_little_else() const {
    EXPECT_GE(removed_movers(), 0.95);
    EXPECT_LE(removed_static(), 0.005);
  }

  void report() const {
    std::printf("crossed movers %.4f, static %.4f removed of %zu voxels\n",
                removed_movers(),
                removed_static(),
                truth_.size());
    for (int k = 0; k < simulator::object_classes; ++k) {
      const auto object_class = static_cast<ObjectClass>(k);
      const double lost = removed_static(object_class);
      if (!std::isnan(lost)) std::printf("  %s %.4f\n", simulator::name(object_class), lost);
    }
  }

 private:
  TrueScan scan_at(std::size_t i) const {
    return session_ ? session_scan(simulator_, *session_, i) : true_scan(simulator_, i);
  }

  void gather(const TrueScan& scan) {
    found_.add_returns(scan.placed);
    for (std::size_t i = 0; i < scan.classes.size(); ++i) {
      TruthOfVoxel& voxel = truth_[index_of(end_of(scan, i)).key()];
      ++(is_moving(scan.classes[i]) ? voxel.moving : voxel.standing);
      voxel.classes |= 1U << static_cast<unsigned>(scan.classes[i]);
    }
  }

  void cast(const TrueScan& scan) {
    found_.add_rays(scan.placed, pool_);
    ++casts_;
    for (std::size_t i = 0; i < scan.classes.size(); ++i) {
      truth_[index_of(end_of(scan, i)).key()].last_hit = casts_;
    }
    for (std::size_t i = 0; i < scan.classes.size(); ++i) {
      traverse(scan.placed.map_from_lidar * scan.placed.origins[i].cast<double>(),
               end_of(scan, i),
               [&](const Index& index) { cross(index); });
    }
  }

  void cross(const Index& index) {
    if (!near_mover(index)) return;
    const auto voxel = truth_.find(index.key());
    if (voxel != truth_.end() && voxel->second.last_hit != casts_) voxel->second.crossed = true;
  }

  /// Most voxels that rays cross are nowhere near a mover: a small table answers for columns.
  bool near_mover(const Index& index) {
    if (mover_columns_.empty()) {
      mover_columns_.assign(1U << 20U, 0);
      for (const auto& [key, voxel] : truth_) {
        const Voxel at = voxel_from_key(key);
        if (voxel.moving > 0) mover_columns_[column_of({{at.x, at.y, at.z}})] = 1;
      }
    }
    return mover_columns_[column_of(index)] != 0;
  }
  static std::size_t column_of(const Index& index) {
    return (static_cast<std::size_t>(index.at[0]) * 5623 +
            static_cast<std::size_t>(index.at[1]) * 3) &
           ((1U << 20U) - 1);
  }

  static Eigen::Vector3d end_of(const TrueScan& scan, std::size_t i) {
    return scan.placed.map_from_lidar * scan.placed.points[i].cast<double>();
  }

  template <class Which>
  double share(Which&& which) const {
    double all = 0.0;
    double removed = 0.0;
    for (const auto& [key, truth] : truth_) {
      if (!which(truth)) continue;
      const Voxel at = voxel_from_key(key);
      all += 1.0;
      removed += found_.moved(voxel_size * Eigen::Vector3d(at.x + 0.5, at.y + 0.5, at.z + 0.5));
    }
    return removed / all;
  }

  Simulator simulator_;
  std::optional<Session> session_;
  std::vector<std::size_t> scans_;
  ThreadPool pool_{0};
  MovedReturns found_;
  std::unordered_map<VoxelKey, TruthOfVoxel> truth_;
  std::vector<std::uint8_t> mover_columns_;
  std::uint32_t casts_ = 0;
};

TEST(MovedReturnsOfALog, PeopleInAnOfficeByTruePoses) {
  simulator::Scenario scenario;
  scenario.world = "office";
  scenario.motion = "robot";
  scenario.columns = 1024;
  scenario.movers = 20;
  const MoverTrial trial(scenario, 1, 8, 500);
  trial.report();
  trial.expect_what_moved_and_little_else();
  for (const ObjectClass thin : {ObjectClass::floor,
                                 ObjectClass::wall,
                                 ObjectClass::door,
                                 ObjectClass::desk_leg,
                                 ObjectClass::chair_leg}) {
    EXPECT_LE(trial.removed_static(thin), 0.05) << simulator::name(thin);
  }
}

/// What `kissmap run` makes of a scenario.
void map_scenario(const simulator::Scenario& scenario, const std::filesystem::path& session) {
  const TempDir folder;
  const std::filesystem::path log = folder.path() / "log";
  write_log_folder(make_simulator(scenario), log, 2, [](std::size_t) {});
  const ProgramResult run = run_program(
      {KISSMAP_BINARY, "run", log / "scans", "-o", session, "--quiet", "--no-products"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
}

TEST(MovedReturnsOfALog, PeopleInAnOfficeByPosesOfSlam) {
  simulator::Scenario scenario;
  scenario.world = "office";
  scenario.motion = "robot";
  scenario.columns = 1024;
  scenario.movers = 20;
  scenario.scans = 1000;
  const TempDir folder;
  map_scenario(scenario, folder.path() / "session");
  if (HasFatalFailure()) return;
  const MoverTrial trial(scenario, 1, 1, 1000, folder.path() / "session");  // as the export does
  trial.report();
  trial.expect_what_moved_and_little_else();
  EXPECT_LE(trial.removed_static(ObjectClass::wall), 0.005);
  EXPECT_LE(trial.removed_static(ObjectClass::floor), 0.005);
  EXPECT_LE(trial.removed_static(ObjectClass::desk), 0.02);
  // Legs of 3 cm move by as much as the poses are off.
  for (const ObjectClass leg : {ObjectClass::desk_leg, ObjectClass::chair_leg}) {
    EXPECT_LE(trial.removed_static(leg), 0.05) << simulator::name(leg);
  }
}

TEST(MovedReturnsOfALog, CarsAndPeopleInATownByTruePoses) {
  simulator::Scenario scenario;
  scenario.columns = 1024;
  scenario.movers = 20;
  const MoverTrial trial(scenario, 100, 1, 150);
  trial.report();
  trial.expect_what_moved_and_little_else();
  for (const ObjectClass thin :
       {ObjectClass::ground, ObjectClass::sidewalk, ObjectClass::pole, ObjectClass::fence}) {
    EXPECT_LE(trial.removed_static(thin), 0.05) << simulator::name(thin);
  }
}

TEST(MovedReturnsOfALog, CarsAndPeopleInATownByPosesOfSlam) {
  simulator::Scenario scenario;
  scenario.columns = 1024;
  scenario.movers = 20;
  scenario.scans = 250;
  const TempDir folder;
  map_scenario(scenario, folder.path() / "session");
  if (HasFatalFailure()) return;
  const MoverTrial trial(scenario, 100, 1, 150, folder.path() / "session");
  trial.report();
  trial.expect_what_moved_and_little_else();
}

}  // namespace
}  // namespace kissmap
