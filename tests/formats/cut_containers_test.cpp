// SPDX-License-Identifier: MIT
// Containers cut at every hundredth of their length: every scan before the cut, and a word about
// the rest, or an error.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "formats/support.hpp"
#include "kissmap/formats/scan_writer.hpp"

namespace kissmap {
namespace {

namespace fs = std::filesystem;
using test::read_all;
using test::scan_of;
using test::TempDir;
using testing::AnyOf;
using testing::HasSubstr;

std::string content_of(const fs::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

Scan scan_number(int k) {
  Scan scan;
  scan.stamp_ns = 1'700'000'000'000'000'000 + std::int64_t{k} * 100'000'000;
  std::uint32_t noise = static_cast<std::uint32_t>(k) + 1;
  for (int i = 0; i < 20'000; ++i) {
    noise = noise * 1664525U + 1013904223U;  // does not pack well: chunks are several
    scan.points.emplace_back(1.0F + static_cast<float>(noise >> 12U) * 1e-4F,
                             static_cast<float>(i),
                             static_cast<float>(k));
  }
  return scan;
}

void expect_same(const LogEntry& got, const LogEntry& expected) {
  const Scan& a = scan_of(got);
  const Scan& b = scan_of(expected);
  EXPECT_EQ(a.stamp_ns, b.stamp_ns);
  EXPECT_TRUE(a.points == b.points);
}

/// Reads a file cut at every hundredth. Returns how many of the cuts gave scans.
int expect_prefixes(const fs::path& file, const std::string& name) {
  const std::vector<LogEntry> whole = read_all(*open_log(file));
  const std::string content = content_of(file);
  const TempDir dir;
  int with_scans = 0;
  for (std::size_t percent = 0; percent < 100; ++percent) {
    const fs::path cut = dir.write(name, content.substr(0, content.size() * percent / 100));
    std::vector<LogEntry> entries;
    try {
      entries = read_all(*open_log(cut));
    } catch (const Error& error) {
      EXPECT_EQ(error.fault(), Fault::input);
      EXPECT_THAT(error.what(), HasSubstr(name));
      continue;
    }
    // The last entry tells of the cut.
    EXPECT_TRUE(std::holds_alternative<RefusedScan>(entries.back().content)) << percent;
    if (!std::holds_alternative<RefusedScan>(entries.back().content)) continue;
    EXPECT_THAT(test::refusal_of(entries.back()).reason,
                AnyOf("truncated file", "broken content", "wrong file size"));
    entries.pop_back();
    EXPECT_LE(entries.size(), whole.size());
    for (std::size_t i = 0; i < entries.size(); ++i) expect_same(entries[i], whole[i]);
    with_scans += entries.empty() ? 0 : 1;
    // Scans are spread evenly: most of what was before the cut is there.
    EXPECT_GE(entries.size() + whole.size() / 3 + 1, whole.size() * percent / 100) << percent;
  }
  return with_scans;
}

TEST(CutContainers, OfMcapGiveWhatCameBefore) {
  const TempDir dir;
  const fs::path file = dir.path() / "whole.mcap";
  const auto writer = open_scan_writer(file, ScanFormat::mcap);
  for (int k = 0; k < 60; ++k) writer->add(scan_number(k));
  writer->finish();
  EXPECT_GT(expect_prefixes(file, "cut.mcap"), 70);
}

TEST(CutContainers, OfARecordedBagGiveWhatCameBefore) {
  const char* data = std::getenv("KISSMAP_TEST_DATA");
  if (data == nullptr) GTEST_SKIP() << "needs the recordings";
  EXPECT_GT(expect_prefixes(fs::path(data) / "pointcloud2" / "hku1_60_pc2_lz4.bag", "cut.bag"), 70);
}

TEST(CutContainers, OfARecordedSqliteBagGiveWhatCameBefore) {
  const char* data = std::getenv("KISSMAP_TEST_DATA");
  if (data == nullptr) GTEST_SKIP() << "needs the recordings";
  const fs::path bag = fs::path(data) / "packets/velodyne/vlp16/1673400471837873222";
  const fs::path file = bag / "1673400471837873222_0.db3";
  const std::size_t whole = read_all(*open_log(file)).size();
  const std::string content = content_of(file);
  const TempDir dir;
  int with_scans = 0;
  for (std::size_t percent = 0; percent < 100; ++percent) {
    const fs::path cut = dir.write("cut.db3", content.substr(0, content.size() * percent / 100));
    try {
      const auto entries = read_all(*open_log(cut));
      EXPECT_TRUE(std::holds_alternative<RefusedScan>(entries.back().content)) << percent;
      EXPECT_LE(entries.size(), whole + 1);
      with_scans += entries.size() > 1 ? 1 : 0;
    } catch (const Error& error) {
      EXPECT_EQ(error.fault(), Fault::input);
      EXPECT_THAT(error.what(), HasSubstr("cut.db3"));
    }
  }
  EXPECT_GT(with_scans, 3);
}

/// Sweeps of a capture cut at every hundredth: those before the cut, the last of them begun.
void expect_sweeps_before_cuts(const fs::path& capture, const fs::path& metadata = {}) {
  const auto whole = read_all(*open_log(capture));
  const std::string content = content_of(capture);
  const TempDir dir;
  if (!metadata.empty()) dir.write("cut.json", content_of(metadata));
  std::size_t most = 0;
  for (std::size_t percent = 0; percent < 100; ++percent) {
    const fs::path cut = dir.write("cut.pcap", content.substr(0, content.size() * percent / 100));
    std::vector<LogEntry> entries;
    try {
      entries = read_all(*open_log(cut));
    } catch (const Error& error) {
      EXPECT_EQ(error.fault(), Fault::input);
      EXPECT_THAT(error.what(), HasSubstr("cut.pcap"));
      continue;
    }
    // A cut between two packets cannot be told from the end of the recording.
    if (std::holds_alternative<RefusedScan>(entries.back().content)) {
      EXPECT_EQ(test::refusal_of(entries.back()).reason, "truncated file");
      entries.pop_back();
    }
    ASSERT_LE(entries.size(), whole.size());
    for (std::size_t i = 0; i + 1 < entries.size(); ++i) expect_same(entries[i], whole[i]);
    most = std::max(most, entries.size());
    if (entries.empty()) continue;
    const auto& begun = scan_of(entries.back()).points;
    const auto& expected = scan_of(whole[entries.size() - 1]).points;
    ASSERT_LE(begun.size(), expected.size()) << percent;
  }
  EXPECT_EQ(most, whole.size());
}

TEST(CutContainers, OfACaptureGiveTheSweepsBefore) {
  const char* data = std::getenv("KISSMAP_TEST_DATA");
  if (data == nullptr) GTEST_SKIP() << "needs the recordings";
  const fs::path packets = fs::path(data) / "packets";
  expect_sweeps_before_cuts(packets / "velodyne/sample_velodyne_hdl32.pcap");
  expect_sweeps_before_cuts(packets / "ouster/OS-1-128_v2.3.0_1024x10_lb_n3.pcap",
                            packets / "ouster/OS-1-128_v2.3.0_1024x10.json");
}

TEST(Containers, PassOverScansWithoutReadingThem) {
  const TempDir dir;
  const fs::path file = dir.path() / "whole.mcap";
  const auto writer = open_scan_writer(file, ScanFormat::mcap);
  for (int k = 0; k < 60; ++k) writer->add(scan_number(k));
  writer->finish();
  for (const std::size_t first : {1U, 2U, 17U, 42U, 59U}) {
    const auto log = open_log(file);
    log->skip(first);
    const auto entry = log->next();
    ASSERT_TRUE(entry.has_value());
    EXPECT_EQ(entry->index, first);
    EXPECT_EQ(entry->name, "/points[" + std::to_string(first) + "]");
    EXPECT_EQ(scan_of(*entry).points[0].z(), static_cast<float>(first));
    EXPECT_EQ(read_all(*log).size(), 59 - first);
  }
  const auto log = open_log(file);
  log->skip(100);
  EXPECT_FALSE(log->next().has_value());
}

}  // namespace
}  // namespace kissmap
