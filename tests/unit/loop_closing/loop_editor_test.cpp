// SPDX-License-Identifier: MIT
#include "kissmap/loop_closing/loop_editor.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <numbers>

#include "kissmap/error.hpp"
#include "support/block_world.hpp"
#include "support/matchers.hpp"

namespace kissmap {
namespace {

using testing::AllOf;
using testing::HasSubstr;

constexpr double voxel_size = 0.5;
constexpr std::uint32_t maps = 8;
constexpr int scans_per_map = 4;

/// A lap through a world of blocks: the last local map shows what the first one does. Odometry
/// drifts by the same motion in each local map; within them it is exact.
struct Lap {
  std::vector<Rigid3> truth;  ///< keyposes
  LoopEvidence evidence;
  std::vector<ScanPlace> scans;
  std::vector<SurfelCloud> surfels;
};

Rigid3 drift() {
  Twist twist;
  twist << 0.2, -0.1, 0.3, 0.002, -0.003, 0.01;
  return exp(twist);
}

std::vector<Eigen::Vector3f> seen_from(const Rigid3& pose,
                                       const std::vector<Eigen::Vector3f>& world) {
  std::vector<Eigen::Vector3f> seen;
  std::ranges::copy_if(world, std::back_inserter(seen), [&pose](const Eigen::Vector3f& point) {
    return (point.cast<double>() - pose.translation).norm() < 30.0;
  });
  return moved(pose.inverse(), seen);
}

Lap make_lap() {
  Lap lap;
  const auto world = block_world(11);
  for (std::uint32_t id = 0; id < maps; ++id) {
    const double angle = 2.0 * std::numbers::pi * id / (maps - 1);  // the last is where 0 is
    const Rigid3 pose{Eigen::Quaterniond(Eigen::AngleAxisd(angle + 1.5, Eigen::Vector3d::UnitZ())),
                      Eigen::Vector3d(20.0 * std::cos(angle), 20.0 * std::sin(angle), 1.5)};
    lap.truth.push_back(lap.truth.empty() ? pose : pose * planar_motion(0.3, -0.2, 1.0));
    lap.surfels.push_back(surfels_of(seen_from(lap.truth.back(), world)));
  }
  const Rigid3 first_from_world = lap.truth.front().inverse();
  for (Rigid3& pose : lap.truth) pose = first_from_world * pose;
  lap.truth.front() = Rigid3{};
  for (std::uint32_t id = 0; id < maps; ++id) {
    auto& keyposes = lap.evidence.map_from_local_map;
    const Rigid3 motion =
        id == 0 ? Rigid3{} : lap.truth[id - 1].inverse() * lap.truth[id] * drift();
    keyposes.push_back(id == 0 ? Rigid3{} : keyposes.back() * motion);
    lap.evidence.path_lengths.push_back(20.0);
  }
  for (std::uint32_t id = 0; id < maps; ++id) {
    const Rigid3 way = id + 1 == maps ? planar_motion(2.0, 0.0, 0.0)
                                      : lap.evidence.map_from_local_map[id].inverse() *
                                            lap.evidence.map_from_local_map[id + 1];
    for (int i = 1; i <= scans_per_map; ++i) {
      lap.scans.push_back({id, exp(static_cast<double>(i) / scans_per_map * log(way))});
    }
  }
  return lap;
}

/// Largest distance of a keypose from the truth [m].
double error_of(const LoopCorrection& correction, const Lap& lap) {
  double error = 0.0;
  for (std::uint32_t id = 0; id < maps; ++id) {
    const Rigid3 off = lap.truth[id].inverse() * correction.graph.map_from_node[id];
    error = std::max(error, off.translation.norm());
  }
  return error;
}

bool same_poses(const LoopCorrection& a, const LoopCorrection& b) {
  const auto same = [](const Rigid3& x, const Rigid3& y) {
    return x.translation == y.translation && x.rotation.coeffs() == y.rotation.coeffs();
  };
  return std::ranges::equal(a.map_from_lidar, b.map_from_lidar, same) &&
         std::ranges::equal(a.map_from_local_map, b.map_from_local_map, same);
}

class LoopEditorTest : public testing::Test {
 protected:
  static const Lap& lap() {
    static const Lap made = make_lap();
    return made;
  }
  static LoopEditor editor(const LoopEvidence& evidence = lap().evidence) {
    return {evidence, lap().scans, {}, voxel_size, [](std::uint32_t id) {
              return lap().surfels.at(id);
            }};
  }
  static Rigid3 true_motion(std::uint32_t from, std::uint32_t to) {
    return lap().truth[from].inverse() * lap().truth[to];
  }
  /// A candidate as a run measured it.
  static Closure candidate(std::uint32_t query,
                           std::uint32_t reference,
                           const Rigid3& reference_from_query,
                           ClosureVerdict verdict,
                           double overlap = 0.5) {
    Closure closure;
    closure.query_id = query;
    closure.reference_id = reference;
    closure.reference_from_query = reference_from_query;
    closure.verdict = verdict;
    closure.first_verdict = verdict;
    closure.overlap = overlap;
    closure.information = information_of(closure);
    return closure;
  }
  template <typename Edit>
  static std::string refusal(const Edit& edit) {
    try {
      edit();
    } catch (const Error& error) {
      EXPECT_EQ(error.fault(), Fault::input);
      return error.what();
    }
    return "accepted";
  }
};

TEST_F(LoopEditorTest, WithoutEditsIsWhatTheEvidenceGives) {
  LoopEditor open = editor();
  EXPECT_TRUE(same_poses(open.correction(), correct_loops(lap().scans, lap().evidence)));
  EXPECT_GT(error_of(open.correction(), lap()), 2.0) << "drift";
}

TEST_F(LoopEditorTest, JoiningTwoLocalMapsClosesTheLoop) {
  LoopEditor loops = editor();
  loops.join(0, maps - 1);
  const LoopCorrection& correction = loops.correction();
  ASSERT_EQ(correction.closures.size(), 1U);
  const Closure& closure = correction.closures[0];
  EXPECT_EQ(closure.query_id, maps - 1);
  EXPECT_EQ(closure.reference_id, 0U);
  EXPECT_EQ(closure.verdict, ClosureVerdict::accepted);
  EXPECT_EQ(reason(closure), "added by hand");
  EXPECT_THAT(closure.reference_from_query, PoseNear(true_motion(0, maps - 1), 0.05, 0.005));
  EXPECT_LT(error_of(correction, lap()), 0.5 * error_of(editor().correction(), lap()));
}

TEST_F(LoopEditorTest, SurfacesDoNotHoldTogetherWhatWasTakenApart) {
  const LoopCorrection open = correct_loops(lap().scans, lap().evidence);
  LoopEvidence evidence = lap().evidence;
  const std::uint32_t first = 1;
  const std::uint32_t last = (maps - 1) * scans_per_map + 1;
  const Rigid3 wrong = open.map_from_lidar[first].inverse() * open.map_from_lidar[last] *
                       planar_motion(0.8, 0.0, 0.0);
  evidence.surfaces.push_back({first, last, wrong, 1e4 * Information::Identity()});
  evidence.closures.push_back(
      candidate(maps - 1, 0, true_motion(0, maps - 1), ClosureVerdict::accepted));
  LoopEditor loops = editor(evidence);
  EXPECT_FALSE(same_poses(loops.correction(), open));
  loops.remove(0, maps - 1);
  EXPECT_TRUE(same_poses(loops.correction(), open));
  EXPECT_EQ(loops.correction().surfaces.size(), 1U) << "they stay in the session";
}

TEST_F(LoopEditorTest, AGuessServesWhereDriftIsTooFar) {
  LoopEvidence far = lap().evidence;
  std::vector<ScanPlace> scans = lap().scans;
  const Rigid3 slip{Eigen::Quaterniond::Identity(), Eigen::Vector3d(60.0, 0.0, 0.0)};
  far.map_from_local_map[7] = far.map_from_local_map[7] * slip;
  Rigid3& last_of_6 = scans[7 * scans_per_map - 1].local_map_from_lidar;
  last_of_6 = last_of_6 * slip;
  LoopEditor loops(
      far, scans, {}, voxel_size, [](std::uint32_t id) { return lap().surfels.at(id); });
  EXPECT_THAT(refusal([&] { loops.join(7, 0); }),
              AllOf(HasSubstr("7 and 0"), HasSubstr("where they lie now"), HasSubstr("near")));
  loops.join(7, 0, true_motion(7, 0) * planar_motion(1.0, 0.5, 2.0));
  EXPECT_THAT(loops.correction().closures[0].reference_from_query,
              PoseNear(true_motion(0, 7), 0.05, 0.005));
}

TEST_F(LoopEditorTest, APoseIsTakenAsItIsInEitherDirection) {
  const Rigid3 pose = true_motion(0, 7) * planar_motion(0.2, 0.0, 0.5);
  LoopEditor forth = editor();
  forth.add(0, 7, pose, {0.1, 0.01});
  EXPECT_THAT(forth.correction().closures[0].reference_from_query, PoseNear(pose, 1e-12, 1e-12));
  LoopEditor back = editor();
  back.add(7, 0, pose.inverse(), {0.1, 0.01});
  for (std::uint32_t id = 0; id < maps; ++id) {
    EXPECT_THAT(back.correction().map_from_local_map[id],
                PoseNear(forth.correction().map_from_local_map[id], 1e-6, 1e-7));
  }
}

TEST_F(LoopEditorTest, SmallerSigmasHoldBetter) {
  const Rigid3 pose = true_motion(0, 7);
  std::vector<double> off;
  for (const double sigma : {0.01, 1.0, 10.0}) {
    LoopEditor loops = editor();
    loops.add(0, 7, pose, {sigma, 0.1 * sigma});
    const LoopCorrection& correction = loops.correction();
    EXPECT_EQ(correction.closures[0].verdict, ClosureVerdict::accepted);
    const Eigen::Vector3d center = correction.closures[0].center_in_query;
    const Rigid3 now =
        correction.map_from_local_map[0].inverse() * correction.map_from_local_map[7];
    off.push_back((now * center - pose * center).norm());
  }
  EXPECT_LT(off[0], off[1]);
  EXPECT_LT(off[1], off[2]);
}

TEST_F(LoopEditorTest, AFalseClosureIsRefusedUnlessFixed) {
  LoopEvidence evidence = lap().evidence;
  for (const auto& [query, reference] : {std::pair{7U, 0U}, {7U, 1U}, {6U, 0U}}) {
    evidence.closures.push_back(
        candidate(query, reference, true_motion(reference, query), ClosureVerdict::accepted));
  }
  LoopEditor loops = editor(evidence);
  const double good = error_of(loops.correction(), lap());
  loops.add(5, 2, true_motion(5, 2) * planar_motion(15.0, 0.0, 30.0), {0.1, 0.01});
  EXPECT_EQ(loops.correction().closures.back().verdict, ClosureVerdict::refused_by_graph);
  EXPECT_EQ(reason(loops.correction().closures.back()), "contradicts other closures");
  EXPECT_LT(error_of(loops.correction(), lap()), good + 0.01);
  loops.fix(2, 5);
  EXPECT_EQ(reason(loops.correction().closures.back()), "added by hand");
  EXPECT_GT(error_of(loops.correction(), lap()), good + 1.0);
  loops.remove(5, 2);
  EXPECT_EQ(loops.correction().closures.size(), 3U);
  EXPECT_TRUE(same_poses(loops.correction(), correct_loops(lap().scans, evidence)));
}

TEST_F(LoopEditorTest, WhatIsRemovedHasNoEffectAndIsMarked) {
  LoopEvidence evidence = lap().evidence;
  evidence.closures = {
      candidate(7, 0, true_motion(0, 7), ClosureVerdict::accepted),
      candidate(6, 0, true_motion(0, 6) * planar_motion(1, 1, 5), ClosureVerdict::accepted)};
  LoopEditor loops = editor(evidence);
  loops.remove(0, 6);
  EXPECT_EQ(reason(loops.correction().closures[1]), "removed by hand");
  EXPECT_EQ(loops.correction().graph.edges.size(), maps);
  evidence.closures.pop_back();
  EXPECT_TRUE(same_poses(loops.correction(), correct_loops(lap().scans, evidence)));
  EXPECT_THAT(refusal([&] { loops.remove(6, 0); }), HasSubstr("refused already: removed by hand"));
  EXPECT_THAT(refusal([&] { loops.fix(6, 0); }), HasSubstr("no closure"));
}

TEST_F(LoopEditorTest, FixTakesTheRefusedCandidateThatOverlapsMost) {
  LoopEvidence evidence = lap().evidence;
  const Rigid3 truth = true_motion(0, 7);
  evidence.closures = {
      candidate(7, 0, planar_motion(30, 0, 0), ClosureVerdict::no_convergence, 0.1),
      candidate(7, 0, truth, ClosureVerdict::low_overlap, 0.39),
      candidate(7, 0, planar_motion(0, 30, 0), ClosureVerdict::walls_disagree, 0.2)};
  LoopEditor loops = editor(evidence);
  const LoopCorrection before = loops.correction();
  loops.fix(7, 0);
  EXPECT_EQ(loops.correction().closures[0].verdict, ClosureVerdict::no_convergence);
  EXPECT_EQ(loops.correction().closures[1].verdict, ClosureVerdict::accepted);
  EXPECT_EQ(reason(loops.correction().closures[1]), "fixed by hand; overlap too low");
  EXPECT_LT(error_of(loops.correction(), lap()), 0.5 * error_of(before, lap()));
  loops.remove(7, 0);
  EXPECT_EQ(reason(loops.correction().closures[1]), "overlap too low");
  EXPECT_TRUE(same_poses(loops.correction(), before));
}

TEST_F(LoopEditorTest, WhatCannotBeDoneIsRefusedAndChangesNothing) {
  LoopEvidence evidence = lap().evidence;
  evidence.closures = {candidate(7, 0, true_motion(0, 7), ClosureVerdict::accepted),
                       candidate(4, 1, true_motion(1, 4), ClosureVerdict::low_overlap)};
  LoopEditor loops = editor(evidence);
  const LoopCorrection before = loops.correction();
  const Rigid3 far{Eigen::Quaterniond::Identity(), Eigen::Vector3d(1e30, 0, 0)};
  EXPECT_THAT(refusal([&] { loops.remove(3, 8); }), HasSubstr("no local map 8, only 0 to 7"));
  EXPECT_THAT(refusal([&] { loops.fix(4000000000U, 3); }), HasSubstr("no local map 4000000000"));
  EXPECT_THAT(refusal([&] { loops.join(3, 3); }), HasSubstr("itself"));
  EXPECT_THAT(refusal([&] { loops.remove(3, 2); }), HasSubstr("no closure between 3 and 2"));
  EXPECT_THAT(refusal([&] { loops.remove(4, 1); }), HasSubstr("refused already: overlap too low"));
  EXPECT_THAT(refusal([&] { loops.fix(3, 2); }), HasSubstr("no candidate between 3 and 2"));
  EXPECT_THAT(refusal([&] { loops.join(0, 7); }), HasSubstr("already; remove it first"));
  EXPECT_THAT(refusal([&] { loops.add(7, 0, {}, {1, 1}); }), HasSubstr("already"));
  EXPECT_THAT(refusal([&] { loops.add(5, 0, far, {1, 1}); }), HasSubstr("100 km"));
  EXPECT_THAT(refusal([&] { loops.join(5, 0, far); }), HasSubstr("100 km"));
  EXPECT_TRUE(same_poses(loops.correction(), before));
  EXPECT_EQ(loops.correction().closures.size(), 2U);
}

TEST(LoopCorrectionTest, VerdictsOfTheSearchDoNotMatter) {
  LoopEvidence evidence;
  for (int i = 0; i < 6; ++i) {
    evidence.map_from_local_map.push_back(planar_motion(5.0 * i, 0.1 * i * i, 0.0));
    evidence.path_lengths.push_back(5.0);
  }
  evidence.map_from_local_map.front() = Rigid3{};
  std::vector<ScanPlace> scans;
  for (std::uint32_t id = 0; id < 6; ++id) scans.push_back({id, planar_motion(5, 0, 0)});
  Closure closure;
  closure.query_id = 5;
  closure.reference_from_query = planar_motion(24.0, 2.0, 0.0);
  closure.information = information_of(closure);
  evidence.closures = {closure};
  const LoopCorrection believed = correct_loops(scans, evidence);
  evidence.closures[0].verdict = ClosureVerdict::refused_by_graph;
  EXPECT_TRUE(same_poses(correct_loops(scans, evidence), believed));
  EXPECT_EQ(believed.closures[0].verdict, ClosureVerdict::accepted);
}

TEST(LoopCorrectionTest, ContradictoryEvidenceIsAnError) {
  LoopEvidence evidence;
  evidence.map_from_local_map.resize(2);
  evidence.path_lengths = {1.0};
  EXPECT_THROW(correct_loops({}, evidence), Error);
  evidence.path_lengths = {1.0, 1.0};
  Closure closure;
  closure.query_id = 7;
  evidence.closures = {closure};
  EXPECT_THROW(correct_loops({}, evidence), Error);
}

}  // namespace
}  // namespace kissmap
