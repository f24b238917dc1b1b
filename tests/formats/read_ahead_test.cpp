// SPDX-License-Identifier: MIT
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <thread>

#include "formats/support.hpp"
#include "kissmap/formats/scan_log.hpp"

namespace kissmap {
namespace {

using test::error_of;
using testing::ElementsAre;
using testing::HasSubstr;

/// `count` scans; throws instead of scan `failing`.
class CountingLog : public ScanLog {
 public:
  struct Counters {
    std::atomic<std::size_t> read = 0;
    std::atomic<std::size_t> skipped = 0;
  };

  CountingLog(std::size_t count, Counters& counters, std::size_t failing = 1'000'000)
      : count_(count), failing_(failing), counters_(counters) {
    info_.scan_count = count;
  }
  const LogInfo& info() const override { return info_; }
  std::optional<LogEntry> next() override {
    if (next_ == failing_) throw input_error("log", "the disk is gone");
    if (next_ >= count_) return std::nullopt;
    ++counters_.read;
    Scan scan;
    scan.stamp_ns = static_cast<std::int64_t>(next_);
    return LogEntry{next_++, "scan", scan};
  }
  void skip(std::size_t count) override {
    counters_.skipped += count;
    next_ = std::min(count_, next_ + count);
  }
  std::vector<LogFile> files() const override { return {{"log", next_, ""}}; }

 private:
  LogInfo info_;
  std::size_t count_;
  std::size_t failing_;
  std::size_t next_ = 0;
  Counters& counters_;
};

std::vector<std::size_t> indices(ScanLog& log) {
  std::vector<std::size_t> result;
  while (const auto entry = log.next()) result.push_back(entry->index);
  return result;
}

TEST(ReadAhead, GivesTheSameEntriesInOrder) {
  for (const std::size_t max_scans : {0U, 1U, 2U, 100U}) {
    CountingLog::Counters counters;
    const auto log = read_ahead(std::make_unique<CountingLog>(50, counters), max_scans);
    const auto got = indices(*log);
    ASSERT_EQ(got.size(), 50U);
    for (std::size_t i = 0; i < got.size(); ++i) EXPECT_EQ(got[i], i);
    EXPECT_FALSE(log->next());
    EXPECT_EQ(log->files()[0].size_bytes, 50U);
  }
}

TEST(ReadAhead, HoldsNoMoreThanItMay) {
  CountingLog::Counters counters;
  const auto log = read_ahead(std::make_unique<CountingLog>(1000, counters), 3);
  EXPECT_EQ(counters.read, 0U);
  for (std::size_t taken = 1; taken <= 5; ++taken) {
    log->next();
    while (counters.read < taken + 3) std::this_thread::yield();
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
    EXPECT_EQ(counters.read, taken + 3);
  }
}

TEST(ReadAhead, DeliversAnErrorBehindTheScansBeforeIt) {
  CountingLog::Counters counters;
  const auto log = read_ahead(std::make_unique<CountingLog>(10, counters, 4), 8);
  for (std::size_t i = 0; i < 4; ++i) EXPECT_EQ(log->next()->index, i);
  EXPECT_THAT(error_of(Fault::input, [&] { log->next(); }), HasSubstr("the disk is gone"));
  EXPECT_FALSE(log->next());
}

TEST(ReadAhead, EndsWhenTheConsumerStopsEarly) {
  for (int i = 0; i < 100; ++i) {
    CountingLog::Counters counters;
    const auto log = read_ahead(std::make_unique<CountingLog>(1'000'000, counters), 2);
    for (int n = 0; n < i % 4; ++n) log->next();
  }
}

TEST(ReadAhead, MayBeAskedForFilesWhileItReads) {
  CountingLog::Counters counters;
  const auto log = read_ahead(std::make_unique<CountingLog>(500, counters), 2);
  while (log->next()) EXPECT_LE(log->files()[0].size_bytes, 500U);
}

TEST(ReadAhead, SkipsInTheLogBeforeItStarts) {
  CountingLog::Counters counters;
  const auto log = read_ahead(std::make_unique<CountingLog>(10, counters), 2);
  log->skip(3);
  EXPECT_EQ(counters.skipped, 3U);
  EXPECT_EQ(log->next()->index, 3U);
  log->skip(2);
  EXPECT_THAT(indices(*log), ElementsAre(6, 7, 8, 9));
}

std::vector<std::size_t> selected(const ScanSelection& selection, std::size_t count = 10) {
  CountingLog::Counters counters;
  const auto log = select_scans(std::make_unique<CountingLog>(count, counters), selection);
  const std::size_t promised = *log->info().scan_count;
  auto result = indices(*log);
  EXPECT_EQ(result.size(), promised);
  EXPECT_EQ(result.size(), counters.read);
  return result;
}

TEST(SelectScans, AgreesWithCountingByHand) {
  for (std::size_t first = 0; first < 10; ++first) {
    for (std::size_t every = 1; every < 12; ++every) {
      for (std::size_t last = first; last < 13; ++last) {
        std::vector<std::size_t> expected;
        for (std::size_t i = 0; i < 10; ++i) {
          if (i >= first && i <= last && (i - first) % every == 0) expected.push_back(i);
        }
        EXPECT_EQ(selected({first, last, every}), expected) << first << last << every;
      }
    }
  }
}

TEST(SelectScans, SurvivesHugeNumbers) {
  constexpr auto huge = static_cast<std::size_t>(-1);
  EXPECT_THAT(selected({8, huge, 1}), ElementsAre(8, 9));
  EXPECT_THAT(selected({1, std::nullopt, huge}), ElementsAre(1));
  EXPECT_THAT(selected({}), testing::SizeIs(10));
}

TEST(SelectScans, SkipsSelectedScans) {
  CountingLog::Counters counters;
  const auto log = select_scans(std::make_unique<CountingLog>(20, counters), {2, 18, 4});
  EXPECT_EQ(log->next()->index, 2U);
  log->skip(2);
  EXPECT_THAT(indices(*log), ElementsAre(14, 18));
  EXPECT_EQ(counters.read, 3U);
}

TEST(SelectScans, RefusesWhatSelectsNothing) {
  const auto message = [](const ScanSelection& selection) {
    return error_of(Fault::usage, [&] { selected(selection); });
  };
  EXPECT_THAT(message({0, std::nullopt, 0}), HasSubstr("every"));
  EXPECT_THAT(message({5, 4, 1}), HasSubstr("last: 4"));
  EXPECT_THAT(message({10, std::nullopt, 1}), HasSubstr("the log ends with scan 9"));
}

}  // namespace
}  // namespace kissmap
