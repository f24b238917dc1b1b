// SPDX-License-Identifier: MIT
#include "formats/session/verified_log.hpp"

#include <gmock/gmock.h>

#include "session/example_scans.hpp"
#include "session/example_session.hpp"
#include "support/fake_log.hpp"

namespace kissmap {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::StartsWith;

std::vector<LogFile> example_files(std::size_t count) {
  std::vector<LogFile> files;
  for (std::size_t i = 0; i < count; ++i) {
    files.push_back({std::to_string(i) + ".pcd", 100 + i, std::string(32, 'a')});
  }
  return files;
}

std::unique_ptr<FakeLog> log_of(const std::vector<LogFile>& files) {
  std::vector<LogEntry> entries;
  for (std::size_t i = 0; i < files.size(); ++i) entries.push_back(entry_of(i, Scan{}));
  return std::make_unique<FakeLog>(std::move(entries), files);
}

std::size_t count_scans(ScanLog& log) {
  std::size_t scans = 0;
  while (log.next()) ++scans;
  return scans;
}

TEST(VerifiedLog, PassesTheSameLog) {
  const auto files = example_files(5);
  const auto log = verify_log(log_of(files), files);
  EXPECT_EQ(count_scans(*log), 5U);
  EXPECT_EQ(log->files(), files);
}

TEST(VerifiedLog, OrderOfTheListDoesNotMatter) {
  auto files = example_files(12);
  const auto log = log_of(files);
  std::ranges::reverse(files);
  EXPECT_EQ(error_of([&] { verify_log(log_of(example_files(12)), files); }), "no error");
}

TEST(VerifiedLog, RefusesOtherSizesNewAndMissingFilesAtOnce) {
  const auto files = example_files(3);
  auto changed = files;
  changed[1].size_bytes = 7;
  EXPECT_THAT(error_of([&] { verify_log(log_of(changed), files); }),
              AllOf(StartsWith("input: "), HasSubstr("1.pcd"), HasSubstr("--log")));
  EXPECT_THAT(error_of([&] { verify_log(log_of(example_files(4)), files); }),
              AllOf(HasSubstr("3.pcd"), HasSubstr("new")));
  EXPECT_THAT(error_of([&] { verify_log(log_of(example_files(2)), files); }),
              AllOf(HasSubstr("2.pcd"), HasSubstr("missing")));
  changed = files;
  changed[1].name = "0a.pcd";
  EXPECT_THAT(error_of([&] { verify_log(log_of(changed), files); }), HasSubstr("0a.pcd"));
}

TEST(VerifiedLog, RefusesOtherContentOnceItWasRead) {
  const auto files = example_files(3);
  auto changed = files;
  changed[1].xxh3 = std::string(32, 'b');
  const auto log = verify_log(log_of(changed), files);
  EXPECT_TRUE(log->next());
  EXPECT_THAT(error_of([&] { count_scans(*log); }),
              AllOf(StartsWith("input: "), HasSubstr("1.pcd"), HasSubstr("content")));
}

TEST(VerifiedLog, RefusesOtherContentOfLongLogsBeforeTheEnd) {
  const auto files = example_files(1000);
  auto changed = files;
  changed[0].xxh3 = std::string(32, 'b');
  const auto log = verify_log(log_of(changed), files);
  std::size_t scans = 0;
  EXPECT_THAT(error_of([&] {
                while (log->next()) ++scans;
              }),
              HasSubstr("0.pcd"));
  EXPECT_LT(scans, 20U);
}

TEST(VerifiedLog, FilesThatWereNeverReadAreNotCompared) {
  auto expected = example_files(3);
  for (LogFile& file : expected) file.xxh3.clear();
  const auto log = verify_log(log_of(example_files(3)), expected);
  EXPECT_EQ(count_scans(*log), 3U);
}

}  // namespace
}  // namespace kissmap
