// SPDX-License-Identifier: MIT
#include <gmock/gmock.h>

#include <fstream>

#include "kissmap/formats/pack.hpp"
#include "kissmap/formats/registry.hpp"
#include "kissmap/formats/session.hpp"
#include "session/example_scans.hpp"
#include "session/example_session.hpp"
#include "support/small_log.hpp"
#include "support/temp_dir.hpp"

namespace kissmap {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::HasSubstr;
using testing::StartsWith;

std::vector<LogEntry> read_all(ScanLog& log) {
  std::vector<LogEntry> entries;
  while (auto entry = log.next()) entries.push_back(std::move(*entry));
  return entries;
}

// A log of 7 scans, and a session made from scans 1, 3 and 5 of it.
class SessionLog : public testing::Test {
 protected:
  SessionLog() {
    fs::create_directory(log_path_);
    for (int i = 0; i < 7; ++i) {
      write_pcd(log_path_ / scan_name(i), example_scan(static_cast<std::uint32_t>(i), 200).points);
    }
    SessionManifest manifest;
    manifest.log.selection = {1, 6, 2};
    const auto log = select_scans(open_log(log_path_), manifest.log.selection);
    entries_ = read_all(*log);
    manifest.log.path = log_path_;
    manifest.log.format = log->info().format;
    manifest.log.stamp_source = log->info().stamp_source;
    manifest.log.files = log->files();
    SessionWriter(path_, false).finish(manifest);
  }

  std::vector<LogEntry> reread(const fs::path& moved_to = {}) const {
    return read_all(*open_session_log(read_session(path_), moved_to));
  }

  void overwrite_bytes(const fs::path& file, std::streamoff at) const {
    std::fstream stream(file, std::ios::in | std::ios::out | std::ios::binary);
    stream.seekp(at);
    stream << "kiss";
  }

  TempDir folder_;
  fs::path log_path_ = folder_.path() / "log";
  fs::path path_ = folder_.path() / "session";
  std::vector<LogEntry> entries_;
};

void expect_same_entries(const std::vector<LogEntry>& found,
                         const std::vector<LogEntry>& expected,
                         float tolerance) {
  ASSERT_EQ(found.size(), expected.size());
  for (std::size_t i = 0; i < expected.size(); ++i) {
    EXPECT_EQ(found[i].index, expected[i].index);
    EXPECT_EQ(found[i].name, expected[i].name);
    const Scan& a = std::get<Scan>(found[i].content);
    const Scan& b = std::get<Scan>(expected[i].content);
    EXPECT_EQ(a.stamp_ns, b.stamp_ns);
    EXPECT_EQ(a.intensities, b.intensities);
    ASSERT_EQ(a.points.size(), b.points.size());
    for (std::size_t k = 0; k < a.points.size(); ++k) {
      ASSERT_LE((a.points[k] - b.points[k]).cwiseAbs().maxCoeff(), tolerance);
    }
  }
}

TEST_F(SessionLog, IsRereadWithTheSameSelection) {
  ASSERT_EQ(entries_.size(), 3U);
  EXPECT_EQ(entries_[2].index, 5U);
  expect_same_entries(reread(), entries_, 0.0F);
}

TEST_F(SessionLog, IsFoundWhereItMovedTo) {
  const fs::path moved = folder_.path() / "moved";
  fs::rename(log_path_, moved);
  EXPECT_THAT(error_of([&] { reread(); }),
              AllOf(StartsWith("input: " + log_path_.string()), HasSubstr("--log")));
  expect_same_entries(reread(moved), entries_, 0.0F);
}

TEST_F(SessionLog, ChangedSizesAndNamesAreRefusedAtOnce) {
  const auto open = [&] { open_session_log(read_session(path_)); };
  write_pcd(log_path_ / scan_name(9), example_scan(9, 10).points);
  EXPECT_THAT(error_of(open), AllOf(StartsWith("input: "), HasSubstr(scan_name(9))));
  fs::remove(log_path_ / scan_name(9));
  EXPECT_EQ(error_of(open), "no error");
  std::ofstream(log_path_ / scan_name(3), std::ios::app) << "more";
  EXPECT_THAT(error_of(open), AllOf(HasSubstr(scan_name(3)), HasSubstr("changed")));
}

TEST_F(SessionLog, ChangedContentIsRefusedWhenItIsRead) {
  overwrite_bytes(log_path_ / scan_name(3), 500);
  EXPECT_THAT(error_of([&] { reread(); }),
              AllOf(StartsWith("input: "), HasSubstr(scan_name(3)), HasSubstr("content")));
}

TEST_F(SessionLog, ContentOutsideTheSelectionDoesNotMatter) {
  overwrite_bytes(log_path_ / scan_name(2), 500);
  expect_same_entries(reread(), entries_, 0.0F);
}

TEST_F(SessionLog, PackMakesTheSessionTravelAlone) {
  const PackSummary summary = pack_session(path_);
  EXPECT_EQ(summary.bytes, fs::file_size(path_ / pack_file_name));
  EXPECT_EQ(summary.points, 600U);
  EXPECT_EQ(summary.resolution, pack_resolution);
  const auto stored = read_session(path_).manifest.pack;
  ASSERT_TRUE(stored);
  EXPECT_EQ(stored->bytes, summary.bytes);
  fs::remove_all(log_path_);
  const fs::path elsewhere = folder_.path() / "elsewhere";
  fs::rename(path_, elsewhere);
  path_ = elsewhere;
  expect_same_entries(reread(), entries_, 0.001001F);
}

TEST_F(SessionLog, FailedPackLeavesTheSessionAsItWas) {
  overwrite_bytes(log_path_ / scan_name(5), 500);
  const std::string manifest = read_file(path_ / "session.json");
  EXPECT_THAT(error_of([&] { pack_session(path_); }), HasSubstr(scan_name(5)));
  EXPECT_EQ(read_file(path_ / "session.json"), manifest);
  EXPECT_FALSE(fs::exists(path_ / pack_file_name));
  EXPECT_FALSE(fs::exists(path_ / (std::string(pack_file_name) + ".partial")));
}

TEST_F(SessionLog, DamagedPackIsRefusedAndCanBeMadeAgain) {
  pack_session(path_);
  const std::string bytes = read_file(path_ / pack_file_name);
  write_file(path_ / pack_file_name, bytes.substr(0, bytes.size() / 2));
  EXPECT_THAT(error_of([&] { reread(); }),
              AllOf(StartsWith("input: "), HasSubstr(pack_file_name), HasSubstr("kissmap pack")));
  fs::remove(path_ / pack_file_name);
  EXPECT_THAT(error_of([&] { reread(); }), HasSubstr(pack_file_name));
  pack_session(path_);
  EXPECT_EQ(read_file(path_ / pack_file_name), bytes);
}

TEST_F(SessionLog, PackedSessionIsALogForAnybody) {
  EXPECT_THAT(error_of([&] { open_log(path_); }), StartsWith("input: ")) << "its local maps are "
                                                                            "no scans";
  pack_session(path_);
  for (const fs::path& path : {path_, path_ / pack_file_name}) {
    const auto log = open_log(path);
    EXPECT_EQ(log->info().format, "packed");
    EXPECT_EQ(read_all(*log).size(), 3U);
  }
}

}  // namespace
}  // namespace kissmap
