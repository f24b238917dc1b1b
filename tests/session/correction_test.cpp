// SPDX-License-Identifier: MIT
// Corrected poses and closures of a session: round trips and damage.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "kissmap/formats/g2o.hpp"
#include "kissmap/formats/session.hpp"
#include "kissmap/formats/session_update.hpp"
#include "session/example_session.hpp"
#include "support/temp_dir.hpp"

namespace kissmap {
namespace {

using testing::AllOf;
using testing::HasSubstr;

Rigid3 small_motion(double size) {
  Twist twist;
  twist << size, -0.3 * size, 0.1, 0.01 * size, 0.02, -0.03;
  return exp(twist);
}

Closure closure(std::uint32_t query, std::uint32_t reference, ClosureVerdict verdict) {
  Closure closure;
  closure.query_id = query;
  closure.reference_id = reference;
  closure.source = query % 2 == 0 ? ClosureSource::appearance : ClosureSource::trajectory;
  closure.verdict = verdict;
  closure.inliers = 17;
  closure.iterations = 9;
  closure.overlap = 0.1 + 0.2;
  closure.wall_agreement = 2.0 / 3.0;
  closure.residual_before = 0.5;
  closure.residual_after = 1.0 / 3.0;
  closure.reference_from_query = small_motion(3.3);
  closure.center_in_query = {1.0 / 7.0, -2.0, 0.25};
  return closure;
}

/// Symmetric, all 21 numbers different.
Information information(double size) {
  Information made = size * Information::Identity();
  for (int row = 0; row < 6; ++row) {
    for (int column = row; column < 6; ++column) {
      made(row, column) += 0.01 * (6 * row + column) / 3.0;
      made(column, row) = made(row, column);
    }
  }
  return made;
}

class CorrectedSession : public testing::Test {
 protected:
  CorrectedSession() {
    example_ = example_session();
    SessionWriter writer(path_, false);
    for (const SessionScan& scan : example_.scans) writer.add_scan(scan);
    const std::vector<SurfelCloud> surfels = example_surfels();
    for (LocalMap local_map : example_.local_maps) {
      local_map.surfels = surfels[local_map.id];
      writer.add_local_map(local_map);
    }
    for (std::size_t i = 0; i < example_.scans.size(); ++i) {
      correction_.map_from_lidar.push_back(small_motion(static_cast<double>(i)));
    }
    for (std::size_t i = 0; i < example_.local_maps.size(); ++i) {
      correction_.map_from_local_map.push_back(small_motion(0.5 * static_cast<double>(i)));
    }
    correction_.closures = {closure(2, 0, ClosureVerdict::accepted),
                            closure(1, 0, ClosureVerdict::walls_disagree)};
    correction_.neighbors = {{0, small_motion(0.7), 3, 4, 12.5},
                             {1, small_motion(-0.2), 0, 1, 0.1}};
    correction_.surfaces = {{0, 2, small_motion(0.4), information(1.0)},
                            {1, 3, small_motion(-0.9), information(2.5)}};
    correction_.graph.map_from_node = correction_.map_from_local_map;
    for (std::uint32_t i = 1; i < example_.local_maps.size(); ++i) {
      correction_.graph.edges.push_back({i - 1, i, small_motion(1.0), Information::Identity()});
      correction_.edge_weights.push_back(1.0);
    }
    writer.correct(correction_);
    writer.finish(example_.manifest);
  }

  /// The error of reading the session with one file changed.
  std::string error_with(const char* name, const std::string& from, const std::string& to) {
    const std::string whole = read_file(path_ / name);
    std::string damaged = whole;
    const std::size_t at = damaged.find(from);
    EXPECT_NE(at, std::string::npos) << name << " has no " << from;
    damaged.replace(at, from.size(), to);
    write_file(path_ / name, damaged);
    const std::string error = error_of([&] {
      read_session(path_);
      read_session_evidence(path_);
    });
    write_file(path_ / name, whole);
    return error;
  }

  TempDir folder_;
  std::filesystem::path path_ = folder_.path() / "session";
  Session example_;
  LoopCorrection correction_;
};

TEST_F(CorrectedSession, ReadersTakeTheCorrectedPoses) {
  const Session read = read_session(path_);
  ASSERT_EQ(read.scans.size(), correction_.map_from_lidar.size());
  for (std::size_t i = 0; i < read.scans.size(); ++i) {
    const MappedScan& scan = read.scans[i].mapped;
    EXPECT_EQ(scan.map_from_lidar.translation, correction_.map_from_lidar[i].translation);
    EXPECT_EQ(scan.map_from_lidar.rotation.coeffs(),
              correction_.map_from_lidar[i].rotation.coeffs());
    EXPECT_EQ(scan.local_map_from_lidar.translation,
              example_.scans[i].mapped.local_map_from_lidar.translation)
        << "odometry stays as it was";
  }
  for (std::size_t i = 0; i < read.local_maps.size(); ++i) {
    EXPECT_EQ(read.local_maps[i].map_from_local_map.translation,
              correction_.map_from_local_map[i].translation);
  }
}

TEST_F(CorrectedSession, KeepsEveryFigureOfAClosure) {
  const Session read = read_session(path_);
  ASSERT_EQ(read.closures.size(), 2U);
  for (std::size_t i = 0; i < 2; ++i) {
    const Closure& a = read.closures[i];
    const Closure& b = correction_.closures[i];
    EXPECT_EQ(a.query_id, b.query_id);
    EXPECT_EQ(a.reference_id, b.reference_id);
    EXPECT_EQ(a.source, b.source);
    EXPECT_EQ(a.verdict, b.verdict);
    EXPECT_EQ(a.inliers, b.inliers);
    EXPECT_EQ(a.overlap, b.overlap);
    EXPECT_EQ(a.wall_agreement, b.wall_agreement);
    EXPECT_EQ(a.residual_after, b.residual_after);
    EXPECT_EQ(a.center_in_query, b.center_in_query);
    EXPECT_EQ(a.reference_from_query.translation, b.reference_from_query.translation);
  }
  EXPECT_THAT(read_file(path_ / "closures.csv"),
              AllOf(HasSubstr("refused,steep surfaces disagree"), HasSubstr("accepted,accepted")));
}

TEST_F(CorrectedSession, KeepsTheLinksOfNeighbours) {
  const std::vector<NeighborLink> read = read_session_evidence(path_).loops.neighbors;
  ASSERT_EQ(read.size(), correction_.neighbors.size());
  for (std::size_t i = 0; i < read.size(); ++i) {
    const NeighborLink& link = correction_.neighbors[i];
    EXPECT_EQ(read[i].reference_id, link.reference_id);
    EXPECT_EQ(read[i].reference_scan, link.reference_scan);
    EXPECT_EQ(read[i].query_scan, link.query_scan);
    EXPECT_EQ(read[i].extent, link.extent);
    EXPECT_EQ(read[i].reference_from_query.translation, link.reference_from_query.translation);
    EXPECT_EQ(read[i].reference_from_query.rotation.coeffs(),
              link.reference_from_query.rotation.coeffs());
  }
}

TEST_F(CorrectedSession, KeepsTheLinksOfSurfaces) {
  const std::vector<SurfaceLink> read = read_session_evidence(path_).loops.surfaces;
  ASSERT_EQ(read.size(), correction_.surfaces.size());
  for (std::size_t i = 0; i < read.size(); ++i) {
    const SurfaceLink& link = correction_.surfaces[i];
    EXPECT_EQ(read[i].reference_scan, link.reference_scan);
    EXPECT_EQ(read[i].query_scan, link.query_scan);
    EXPECT_EQ(read[i].reference_from_query.translation, link.reference_from_query.translation);
    EXPECT_EQ(read[i].information, link.information);
  }
}

TEST_F(CorrectedSession, TheGraphIsAG2oFile) {
  const GraphFile file = read_g2o(path_ / "pose_graph.g2o");
  EXPECT_EQ(file.ids.size(), example_.local_maps.size());
  EXPECT_EQ(file.graph.edges.size(), correction_.graph.edges.size());
}

TEST_F(CorrectedSession, DamageIsNamed) {
  EXPECT_THAT(error_with("closures.csv", "\n2,0,", "\n9,0,"),
              AllOf(HasSubstr("closures.csv"), HasSubstr("no local map")));
  EXPECT_THAT(error_with("closures.csv", "steep surfaces disagree", "bad weather"),
              HasSubstr("none of the known words"));
  EXPECT_THAT(error_with("closures.csv", "steep surfaces disagree", "fixed by hand; by me"),
              HasSubstr("none of the known words"));
  EXPECT_THAT(error_with("closures.csv", "steep surfaces disagree", "fixed by hands"),
              HasSubstr("none of the known words"));
  EXPECT_THAT(error_with("closures.csv", ",trajectory,", ",hand,"), HasSubstr("holds 1 rows"));
  EXPECT_THAT(error_with("neighbors.csv", "\n1,2,", "\n1,0,"),
              AllOf(HasSubstr("neighbors.csv"), HasSubstr("line 3"), HasSubstr("after")));
  EXPECT_THAT(error_with("neighbors.csv", "\n1,2,", "\n2,3,"), HasSubstr("no local map"));
  EXPECT_THAT(error_with("surfaces.csv", "\n1,3,", "\n1,99,"),
              AllOf(HasSubstr("surfaces.csv"), HasSubstr("line 3"), HasSubstr("no scan")));
  EXPECT_THAT(error_with("surfaces.csv", "\n1,3,", "\n3,1,"), HasSubstr("not later"));
  EXPECT_THAT(error_with("keyposes.csv", "\n1,", "\n2,"),
              AllOf(HasSubstr("keyposes.csv"), HasSubstr("line 3")));
  EXPECT_THAT(error_with("poses.csv", "\n3,", "\n7,"), HasSubstr("line 2"));
  const std::string poses = read_file(path_ / "poses.csv");
  write_file(path_ / "poses.csv", poses.substr(0, poses.rfind('\n', poses.size() - 2) + 1));
  EXPECT_THAT(error_of([&] { read_session(path_); }), HasSubstr("fewer rows"));
}

TEST_F(CorrectedSession, MissingMeasurementsAreNamed) {
  for (const char* name : {"closures.csv", "neighbors.csv", "surfaces.csv"}) {
    std::filesystem::rename(path_ / name, folder_.path() / "away");
    EXPECT_THAT(error_of([&] { read_session_evidence(path_); }),
                AllOf(HasSubstr(name), HasSubstr("holds 0 rows")));
    std::filesystem::rename(folder_.path() / "away", path_ / name);
  }
}

TEST(SessionCorrectionTest, MustPlaceEveryScan) {
  const TempDir folder;
  const Session example = example_session();
  SessionWriter writer(folder.path() / "session", false);
  for (const SessionScan& scan : example.scans) writer.add_scan(scan);
  EXPECT_THAT(error_of([&] { writer.correct({}); }), HasSubstr("place every scan"));
}

}  // namespace
}  // namespace kissmap
