// SPDX-License-Identifier: MIT
// Sessions changed in place and copied: whole or refused, whatever happens.
#include "kissmap/formats/session_update.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "formats/session/session_folder.hpp"
#include "kissmap/loop_closing/closure_validation.hpp"
#include "kissmap/version.hpp"
#include "session/example_session.hpp"
#include "support/file_size_limit.hpp"
#include "support/folder_content.hpp"
#include "support/temp_dir.hpp"

namespace kissmap {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::StartsWith;

Closure closure(ClosureSource source, ClosureVerdict verdict, ClosureVerdict first, bool trusted) {
  Closure made;
  made.query_id = 2;
  made.source = source;
  made.verdict = verdict;
  made.first_verdict = first;
  made.trusted = trusted;
  made.overlap = 1.0 / 3.0;
  made.center_in_query = {5.0, -1.0 / 7.0, 0.1};
  return made;
}

/// One for each reason there is.
std::vector<Closure> all_reasons() {
  constexpr ClosureVerdict accepted = ClosureVerdict::accepted;
  const ClosureSource run = ClosureSource::trajectory;
  std::vector<Closure> closures;
  for (const ClosureVerdict first : {accepted,
                                     ClosureVerdict::no_convergence,
                                     ClosureVerdict::low_overlap,
                                     ClosureVerdict::walls_disagree,
                                     ClosureVerdict::unobservable,
                                     ClosureVerdict::beyond_drift}) {
    closures.push_back(closure(run, first, first, false));
    closures.push_back(closure(run, accepted, first, true));
  }
  closures.push_back(closure(run, ClosureVerdict::refused_by_graph, accepted, false));
  closures.push_back(closure(run, ClosureVerdict::removed_by_hand, accepted, false));
  closures.push_back(closure(ClosureSource::hand, accepted, accepted, false));
  closures.push_back(
      closure(ClosureSource::hand, ClosureVerdict::refused_by_graph, accepted, false));
  return closures;
}

class SessionUpdates : public testing::Test {
 protected:
  SessionUpdates() {
    Session example = example_session();
    example.manifest.program_version = version();
    SessionWriter writer(path_, false);
    for (const SessionScan& scan : example.scans) writer.add_scan(scan);
    const std::vector<SurfelCloud> surfels = example_surfels();
    for (LocalMap local_map : example.local_maps) {
      local_map.surfels = surfels[local_map.id];
      writer.add_local_map(local_map);
    }
    writer.correct(correction(1.0));
    writer.finish(example.manifest);
    update_session(read_session_evidence(path_), update(1.0));  // gives it a picture
    before_ = content_of(path_);
  }

  static LoopCorrection correction(double size) {
    std::mt19937 random(static_cast<unsigned>(size));
    const Session example = example_session();
    LoopCorrection made;
    for (std::size_t i = 0; i < example.scans.size(); ++i) {
      made.map_from_lidar.push_back(random_pose(random));
    }
    for (std::size_t i = 0; i < example.local_maps.size(); ++i) {
      made.map_from_local_map.push_back(random_pose(random));
    }
    made.graph.map_from_node = made.map_from_local_map;
    made.neighbors = {{0, random_pose(random), 1, 2, 7.25}};
    made.surfaces = {{0, 1, random_pose(random), Information::Identity()}};
    made.closures = all_reasons();
    return made;
  }
  static SessionUpdate update(double size, const std::string& edits = "") {
    return {correction(size), edits};
  }
  std::string error_of_update(const SessionUpdate& wanted) const {
    return error_of([&] { update_session(read_session_evidence(path_), wanted); });
  }

  TempDir folder_;
  fs::path path_ = folder_.path() / "session";
  fs::path copy_ = folder_.path() / "copy";
  std::map<std::string, std::string> before_;
};

TEST_F(SessionUpdates, EveryReasonComesBack) {
  const std::vector<Closure> read = read_session(path_).closures;
  const std::vector<Closure> written = all_reasons();
  ASSERT_EQ(read.size(), written.size());
  for (std::size_t i = 0; i < read.size(); ++i) {
    EXPECT_EQ(reason(read[i]), reason(written[i]));
    EXPECT_EQ(read[i].verdict, written[i].verdict) << reason(written[i]);
    EXPECT_EQ(read[i].first_verdict, written[i].first_verdict) << reason(written[i]);
    EXPECT_EQ(read[i].trusted, written[i].trusted) << reason(written[i]);
    EXPECT_EQ(read[i].source, written[i].source) << reason(written[i]);
  }
}

TEST_F(SessionUpdates, EvidenceIsWhatTheRunMeasured) {
  const SessionEvidence evidence = read_session_evidence(path_);
  const Session example = example_session();
  for (std::size_t i = 0; i < example.local_maps.size(); ++i) {
    EXPECT_EQ(evidence.loops.map_from_local_map[i].translation,
              example.local_maps[i].map_from_local_map.translation);
    EXPECT_EQ(evidence.loops.path_lengths[i], example.local_maps[i].path_length);
  }
  std::size_t hands = 0;
  for (const Closure& written : all_reasons()) {
    hands += written.source == ClosureSource::hand ? 1 : 0;
  }
  ASSERT_EQ(evidence.loops.closures.size() + hands, all_reasons().size());
  for (const Closure& measured : evidence.loops.closures) {
    EXPECT_NE(measured.source, ClosureSource::hand);
    EXPECT_EQ(measured.verdict, measured.first_verdict);
    EXPECT_FALSE(measured.trusted);
    EXPECT_EQ(measured.information, information_of(measured));
  }
}

TEST_F(SessionUpdates, ChangesAllThatFollowsAndNothingElse) {
  update_session(read_session_evidence(path_), update(2.0, "fix 2 0\n"));
  const auto after = content_of(path_);
  EXPECT_THAT(differing(before_, after),
              ElementsAre("keyposes.csv",
                          "map.png",
                          "neighbors.csv",
                          "pose_graph.g2o",
                          "poses.csv",
                          "surfaces.csv",
                          "trajectory.tum",
                          "trajectory_kitti.txt",
                          "edits.txt"));
  EXPECT_EQ(after.at("edits.txt"), "fix 2 0\n");
  EXPECT_FALSE(fs::exists(path_ / "optimize.partial"));
  const Session read = read_session(path_);
  EXPECT_EQ(read.scans[5].mapped.map_from_lidar.translation,
            correction(2.0).map_from_lidar[5].translation);
  update_session(read_session_evidence(path_), update(1.0));
  EXPECT_THAT(differing(before_, content_of(path_)), IsEmpty());
}

TEST_F(SessionUpdates, WhatWasMeasuredIsNeverLost) {
  SessionUpdate fewer_closures = update(2.0);
  fewer_closures.correction->closures.erase(fewer_closures.correction->closures.begin());
  SessionUpdate fewer_neighbors = update(2.0);
  fewer_neighbors.correction->neighbors.clear();
  SessionUpdate fewer_surfaces = update(2.0);
  fewer_surfaces.correction->surfaces.clear();
  SessionUpdate fewer_scans = update(2.0);
  fewer_scans.correction->map_from_lidar.pop_back();
  for (const SessionUpdate& wanted :
       {SessionUpdate{}, fewer_closures, fewer_neighbors, fewer_surfaces, fewer_scans}) {
    EXPECT_THAT(error_of_update(wanted), StartsWith("internal: "));
    EXPECT_THAT(error_of([&] { copy_session(read_session_evidence(path_), wanted, copy_, false); }),
                StartsWith("internal: "));
  }
  EXPECT_THAT(differing(before_, content_of(path_)), IsEmpty());
}

TEST_F(SessionUpdates, LoopsLeftOpenCanBeClosedAndOpenedAgain) {
  const fs::path open = folder_.path() / "open";
  write_session(example_session(), example_surfels(), open);
  update_session(read_session_evidence(open), {});
  const auto before = content_of(open);
  EXPECT_FALSE(before.contains("closures.csv"));
  EXPECT_FALSE(read_session(open).corrected);
  SessionUpdate by_hand = update(2.0, "add 2 0\n");
  by_hand.correction->neighbors.clear();
  by_hand.correction->surfaces.clear();
  std::erase_if(by_hand.correction->closures,
                [](const Closure& c) { return c.source != ClosureSource::hand; });
  update_session(read_session_evidence(open), by_hand);
  EXPECT_TRUE(read_session(open).corrected);
  EXPECT_EQ(read_session(open).closures.size(), 2U);
  update_session(read_session_evidence(open), {});
  EXPECT_THAT(differing(before, content_of(open)), IsEmpty());
}

TEST_F(SessionUpdates, ACopyEqualsTheSessionChangedInPlace) {
  const SessionUpdate wanted = update(2.0, "fix 2 0\n");
  copy_session(read_session_evidence(path_), wanted, copy_, false);
  EXPECT_THAT(differing(before_, content_of(path_)), IsEmpty()) << "the original stays";
  update_session(read_session_evidence(path_), wanted);
  EXPECT_THAT(differing(content_of(copy_), content_of(path_)), IsEmpty());
  EXPECT_THAT(error_of([&] { copy_session(read_session_evidence(path_), wanted, copy_, false); }),
              HasSubstr("exists already"));
  copy_session(read_session_evidence(path_), update(1.0), copy_, true);
  EXPECT_THAT(differing(before_, content_of(copy_)), IsEmpty());
}

TEST_F(SessionUpdates, AFullDiskChangesNothing) {
  const SessionUpdate wanted = update(2.0, "fix 2 0\n");
  std::size_t largest = 0;
  for (const char* name : {"keyposes.csv", "poses.csv", "closures.csv", "map.png"}) {
    largest = std::max(largest, before_.at(name).size());
  }
  for (std::size_t bytes = 16; bytes < largest; bytes *= 2) {
    const FileSizeLimit limit(bytes);
    ASSERT_THAT(error_of_update(wanted), StartsWith("output: ")) << bytes;
    ASSERT_THAT(error_of([&] { copy_session(read_session_evidence(path_), wanted, copy_, false); }),
                StartsWith("output: "))
        << bytes;
    EXPECT_FALSE(fs::exists(copy_));
    EXPECT_FALSE(fs::exists(path_ / "optimize.partial"));
  }
  EXPECT_THAT(differing(before_, content_of(path_)), IsEmpty());
}

TEST_F(SessionUpdates, WhatIsInTheWayIsNotTouched) {
  write_file(path_ / "optimize.partial", "mine");
  EXPECT_THAT(error_of_update(update(2.0)), AllOf(StartsWith("output: "), HasSubstr("in the way")));
  fs::remove(path_ / "optimize.partial");
  fs::create_directory(path_ / "optimize.partial");
  write_file(path_ / "optimize.partial" / "notes.txt", "mine");
  EXPECT_THAT(error_of_update(update(2.0)), HasSubstr("notes.txt"));
  EXPECT_EQ(read_file(path_ / "optimize.partial" / "notes.txt"), "mine");
  EXPECT_THAT(first_foreign_name(path_), HasSubstr("notes.txt")) << "nor by an overwrite";
}

TEST_F(SessionUpdates, TwoDoNotMeet) {
  const FolderLock lock(path_);
  ASSERT_TRUE(lock.take());
  EXPECT_THAT(error_of_update(update(2.0)), HasSubstr("another run"));
  EXPECT_THAT(differing(before_, content_of(path_)), IsEmpty());
}

TEST_F(SessionUpdates, SurfelsThatAreMissingAreNamedAndChangeNothing) {
  fs::rename(path_ / "local_maps" / "000001.ply", folder_.path() / "away");
  EXPECT_THAT(error_of_update(update(2.0)), AllOf(StartsWith("input: "), HasSubstr("000001.ply")));
  EXPECT_THAT(error_of([&] { require_local_maps(read_session(path_)); }),
              AllOf(StartsWith("input: "), HasSubstr("000001.ply"), HasSubstr("is missing")));
  EXPECT_THAT(
      error_of([&] { copy_session(read_session_evidence(path_), update(2.0), copy_, false); }),
      HasSubstr("000001.ply"));
  EXPECT_FALSE(fs::exists(copy_));
  fs::rename(folder_.path() / "away", path_ / "local_maps" / "000001.ply");
  EXPECT_THAT(differing(before_, content_of(path_)), IsEmpty());
}

TEST_F(SessionUpdates, SessionsWithoutAllMeasurementsAreRefusedWithTheCure) {
  std::string manifest = read_file(path_ / "session.json");
  const std::size_t at = manifest.find(",\n    \"neighbors\"");
  ASSERT_NE(at, std::string::npos);
  manifest.erase(at, manifest.find_first_of(",\n", at + 2) - at);
  write_file(path_ / "session.json", manifest);
  EXPECT_EQ(error_of([&] { read_session(path_); }), "no error") << "others can still read it";
  EXPECT_THAT(error_of([&] { read_session_evidence(path_); }), HasSubstr("kissmap run"));
}

}  // namespace
}  // namespace kissmap
