// SPDX-License-Identifier: MIT
#include <gmock/gmock.h>

#include "kissmap/formats/session.hpp"
#include "session/example_session.hpp"
#include "support/temp_dir.hpp"

namespace kissmap {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::HasSubstr;
using testing::StartsWith;

class SessionFolder : public testing::Test {
 protected:
  void write(bool overwrite = false) const {
    write_session(example_session(), example_surfels(), path_, overwrite);
  }
  std::string error_of_writer(bool overwrite) const {
    return error_of([&] { SessionWriter(path_, overwrite); });
  }
  TempDir folder_;
  fs::path path_ = folder_.path() / "session";
  fs::path partial_ = folder_.path() / "session.partial";
};

TEST_F(SessionFolder, GetsItsNameOnlyWhenComplete) {
  SessionWriter writer(path_, false);
  EXPECT_EQ(writer.partial_path(), partial_);
  EXPECT_FALSE(fs::exists(path_));
  writer.finish({});
  EXPECT_TRUE(is_session(path_));
  EXPECT_FALSE(fs::exists(partial_));
}

TEST_F(SessionFolder, HoldsEveryRowAsSoonAsItWasAdded) {
  const Session session = example_session();
  SessionWriter writer(path_, false);
  writer.add_scan(session.scans[0]);
  const std::string one_row = read_file(partial_ / "scans.csv");
  EXPECT_EQ(std::ranges::count(one_row, '\n'), 2);
  writer.add_local_map(session.local_maps[0]);
  EXPECT_TRUE(fs::exists(partial_ / "local_maps" / "000000.ply"));
  const std::string one_map = read_file(partial_ / "local_maps.csv");
  EXPECT_EQ(std::ranges::count(one_map, '\n'), 2);
}

TEST_F(SessionFolder, StaysForInspectionWithoutFinish) {
  { SessionWriter writer(path_, false); }
  EXPECT_FALSE(fs::exists(path_));
  EXPECT_TRUE(is_session(partial_));
  EXPECT_THAT(error_of([&] { read_session(partial_); }),
              AllOf(StartsWith("input: "), HasSubstr("never finished"), HasSubstr("kissmap run")));
  EXPECT_THAT(error_of([&] { read_session(path_); }),
              AllOf(StartsWith("input: "), HasSubstr("session.partial"), HasSubstr("kissmap run")));
}

TEST_F(SessionFolder, TellsBeforeTheEndWhatItIsMadeFrom) {
  SessionWriter writer(path_, false);
  writer.describe(example_session().manifest);
  EXPECT_THAT(read_file(partial_ / "config.toml"), HasSubstr("max_range"));
  EXPECT_THAT(read_file(partial_ / "session.json"), HasSubstr("file names"));
  EXPECT_THAT(error_of([&] { read_session(partial_); }), HasSubstr("never finished"));
}

TEST_F(SessionFolder, ExistingPathIsRefused) {
  write();
  EXPECT_THAT(error_of_writer(false),
              AllOf(StartsWith("output: " + path_.string()), HasSubstr("exists already")));
}

TEST_F(SessionFolder, OverwriteReplacesASession) {
  write();
  fs::create_directory(path_ / "local_maps" / "..");
  write_file(path_ / "map.png", "old");
  write(true);
  EXPECT_FALSE(fs::exists(path_ / "map.png"));
  EXPECT_EQ(read_session(path_).scans.size(), example_session().scans.size());
  EXPECT_FALSE(fs::exists(folder_.path() / "session.replaced"));
}

TEST_F(SessionFolder, OverwriteKeepsTheOldSessionUntilTheNewOneIsComplete) {
  write();
  { SessionWriter writer(path_, true); }
  EXPECT_EQ(read_session(path_).scans.size(), example_session().scans.size());
}

TEST_F(SessionFolder, OverwriteNeverTouchesWhatIsNoSession) {
  fs::create_directory(path_);
  EXPECT_THAT(error_of_writer(true), HasSubstr("not a session folder"));
  write_file(path_ / "session.json", "{\"format\": \"something else\"}");
  EXPECT_THAT(error_of_writer(true), HasSubstr("not a session folder"));
  fs::remove_all(path_);
  write_file(path_, "a file");
  EXPECT_THAT(error_of_writer(true), HasSubstr("not a session folder"));
  EXPECT_EQ(read_file(path_), "a file");
}

TEST_F(SessionFolder, OverwriteNeverFollowsALink) {
  write();
  const fs::path link = folder_.path() / "link";
  fs::create_symlink(path_, link);
  EXPECT_THAT(error_of([&] { SessionWriter(link, true); }), HasSubstr("not a session folder"));
}

TEST_F(SessionFolder, OverwriteKeepsWhatAUserPutIntoASession) {
  write();
  write_file(path_ / "notes.txt", "mine");
  EXPECT_THAT(error_of_writer(true), HasSubstr("notes.txt"));
  fs::remove(path_ / "notes.txt");
  write_file(path_ / "local_maps" / "edited.ply", "mine");
  EXPECT_THAT(error_of_writer(true), HasSubstr("edited.ply"));
}

TEST_F(SessionFolder, StalePartialIsReplaced) {
  { SessionWriter writer(path_, false); }
  write_file(partial_ / "packed_log.kmpack.partial", "stopped here");
  write();
  EXPECT_FALSE(fs::exists(path_ / "packed_log.kmpack.partial"));
}

TEST_F(SessionFolder, StalePartialWithForeignFilesIsRefused) {
  fs::create_directory(partial_);
  write_file(partial_ / "thesis.tex", "mine");
  EXPECT_THAT(error_of_writer(false), AllOf(StartsWith("output: "), HasSubstr("thesis.tex")));
  EXPECT_EQ(read_file(partial_ / "thesis.tex"), "mine");
}

TEST_F(SessionFolder, TwoWritersOfOnePathDoNotMeet) {
  SessionWriter first(path_, false);
  EXPECT_THAT(error_of_writer(false), HasSubstr("another run"));
  first.finish({});
  EXPECT_TRUE(is_session(path_));
}

TEST_F(SessionFolder, InterruptedOverwriteIsNotBuriedByTheNext) {
  write();
  fs::rename(path_, folder_.path() / "session.replaced");
  EXPECT_THAT(error_of_writer(true), HasSubstr("session.replaced"));
}

TEST_F(SessionFolder, TrailingSlashIsTheSamePath) {
  write_session(example_session(), example_surfels(), path_ / "");
  EXPECT_EQ(read_session(path_ / "").scans.size(), example_session().scans.size());
}

TEST_F(SessionFolder, MissingParentIsAnErrorWithACure) {
  const fs::path deep = folder_.path() / "missing" / "session";
  EXPECT_THAT(error_of([&] { SessionWriter(deep, false); }),
              AllOf(StartsWith("output: " + deep.string()), HasSubstr("folder")));
}

TEST_F(SessionFolder, NamelessPathsAreRefused) {
  for (const char* path : {"", ".", "..", "/"}) {
    EXPECT_THAT(error_of([&] { SessionWriter(path, true); }), StartsWith("output: ")) << path;
  }
}

TEST_F(SessionFolder, ContradictionsAreDefectsOfTheCaller) {
  const Session session = example_session();
  SessionWriter writer(path_, false);
  writer.add_scan(session.scans[1]);
  EXPECT_THAT(error_of([&] { writer.add_scan(session.scans[0]); }), StartsWith("internal: "));
  EXPECT_THAT(error_of([&] { writer.add_local_map(session.local_maps[1]); }),
              StartsWith("internal: "));
  EXPECT_THAT(error_of([&] { writer.finish({}); }), HasSubstr("scans_used"));
  SessionManifest manifest;
  manifest.counts.scans_used = 1;
  EXPECT_THAT(error_of([&] { writer.finish(manifest); }), HasSubstr("local map"));
  SessionScan broken = session.scans[2];
  broken.mapped.local_map_from_lidar.translation.x() = std::nan("");
  EXPECT_THAT(error_of([&] { writer.add_scan(broken); }), StartsWith("internal: "));
  writer.add_local_map(session.local_maps[0]);
  writer.finish(manifest);
  EXPECT_EQ(read_session(path_).scans.size(), 1U);
}

}  // namespace
}  // namespace kissmap
