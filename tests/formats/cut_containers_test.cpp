// SPDX-License-Identifier: MIT
// Containers cut at every hundredth of their length: every scan that lies before the cut, and a
// word about the rest, or an error where there is none. scans_before_cuts.py, which knows the
// layouts and nothing of kissmap, says how many those are.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <optional>
#include <sstream>

#include "formats/packet_bag.hpp"
#include "formats/sensors/velodyne_decoder.hpp"
#include "formats/support.hpp"
#include "kissmap/formats/scan_writer.hpp"
#include "support/program.hpp"

namespace kissmap {
namespace {

namespace fs = std::filesystem;
using test::Bytes;
using test::read_all;
using test::scan_of;
using test::TempDir;
using testing::AnyOf;
using testing::HasSubstr;

constexpr int scan_count = 60;

/// So many scans have to come out of a cut file, and no more than that.
struct Bounds {
  std::size_t least = 0, most = 0;
};

std::vector<Bounds> bounds_by_python(const fs::path& file, const std::string& topic) {
  const ProgramResult counted = run_program(
      {KISSMAP_TEST_PYTHON, "-I", KISSMAP_TEST_SOURCES "/scans_before_cuts.py", file, topic});
  if (counted.exit_code != 0) throw std::runtime_error(counted.err);
  std::istringstream text(counted.out);
  std::vector<Bounds> bounds;
  for (Bounds b; text >> b.least >> b.most;) bounds.push_back(b);
  return bounds;
}

void expect_same(const Scan& scan, const Scan& expected) {
  EXPECT_EQ(scan.stamp_ns, expected.stamp_ns);
  EXPECT_TRUE(scan.points == expected.points);
  EXPECT_TRUE(scan.intensities == expected.intensities);
  EXPECT_TRUE(scan.time_offsets == expected.time_offsets);
}

/// What a cut file gives; nothing where it cannot be opened, which has to say why.
std::optional<std::vector<LogEntry>> read_cut(const fs::path& cut) {
  try {
    return read_all(*open_log(cut));
  } catch (const Error& error) {
    EXPECT_EQ(error.fault(), Fault::input);
    EXPECT_THAT(error.what(), HasSubstr(cut.filename().string()));
    EXPECT_THAT(error.what(),
                AnyOf(HasSubstr("0 bytes"),
                      HasSubstr("ends"),
                      HasSubstr("damaged"),
                      HasSubstr("no summary"),
                      HasSubstr("no index")));
    return std::nullopt;
  }
}

/// Takes the refused scan at the end, which tells of the cut.
void take_warning(const fs::path& cut, std::vector<LogEntry>& entries, bool complete) {
  ASSERT_FALSE(entries.empty());
  if (std::holds_alternative<RefusedScan>(entries.back().content)) {
    const RefusedScan& refused = test::refusal_of(entries.back());
    EXPECT_THAT(refused.reason, AnyOf("truncated file", "broken content", "wrong file size"));
    EXPECT_THAT(refused.detail, HasSubstr(cut.filename().string()));
    entries.pop_back();
    return;
  }
  // Where only tables at the end are gone, and no scan is, a note says so.
  EXPECT_TRUE(complete);
  EXPECT_THAT(open_log(cut)->info().notes,
              testing::Contains(AnyOf(HasSubstr("no summary"), HasSubstr("no index"))));
}

/// `expected(n)`: the scans of the first n messages.
void expect_scans_before_cuts(const fs::path& file,
                              const std::string& topic,
                              std::size_t messages,
                              const std::function<std::vector<Scan>(std::size_t)>& expected) {
  const std::vector<Bounds> bounds = bounds_by_python(file, topic);
  ASSERT_EQ(bounds.size(), 100U);
  EXPECT_GT(bounds[99].least, messages / 2);  // so there is something to read
  const std::string content = file_text(file);
  const TempDir dir;
  for (std::size_t percent = 0; percent < 100; ++percent) {
    SCOPED_TRACE(file.filename().string() + " cut at " + std::to_string(percent) + " %");
    const fs::path cut = dir.write("cut_" + file.filename().string(),
                                   content.substr(0, content.size() * percent / 100));
    auto entries = read_cut(cut);
    if (!entries) {
      EXPECT_EQ(bounds[percent].least, 0U);
      continue;
    }
    take_warning(cut, *entries, bounds[percent].least == messages);
    EXPECT_GE(entries->size(), expected(bounds[percent].least).size());
    const std::vector<Scan> most = expected(bounds[percent].most);
    ASSERT_LE(entries->size(), most.size());
    for (std::size_t i = 0; i < entries->size(); ++i) expect_same(scan_of((*entries)[i]), most[i]);
  }
}

/// Where a message is a scan.
void expect_scans_before_cuts(const fs::path& file,
                              const std::string& topic,
                              std::size_t messages) {
  std::vector<Scan> whole;
  for (const LogEntry& entry : read_all(*open_log(file))) whole.push_back(scan_of(entry));
  ASSERT_EQ(whole.size(), messages);
  expect_scans_before_cuts(file, topic, messages, [&](std::size_t n) {
    return std::vector<Scan>(whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(n));
  });
}

Scan scan_number(int k, int points = 2'000) {
  Scan scan;
  scan.stamp_ns = 1'700'000'000'000'000'000 + std::int64_t{k} * 1'000'000'000;
  std::uint32_t noise = static_cast<std::uint32_t>(k) + 1;
  for (int i = 0; i < points; ++i) {
    noise = noise * 1664525U + 1013904223U;  // does not pack well: chunks are several
    scan.points.emplace_back(1.0F + static_cast<float>(noise >> 12U) * 1e-4F,
                             static_cast<float>(i),
                             static_cast<float>(k));
  }
  return scan;
}

/// The same scans as binary PCD files, for the writers of others.
fs::path write_folder(const TempDir& dir) {
  for (int k = 0; k < scan_count; ++k) {
    const Scan scan = scan_number(k);
    Bytes points;
    for (const Eigen::Vector3f& p : scan.points) {
      points.add<float>(p.x()).add<float>(p.y()).add<float>(p.z());
    }
    const std::string count = std::to_string(scan.points.size());
    dir.write("log/" + std::to_string(scan.stamp_ns / 1'000'000'000) + "_000000000.pcd",
              "VERSION 0.7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\nWIDTH " + count +
                  "\nHEIGHT 1\nPOINTS " + count + "\nDATA binary\n" + points.text());
  }
  return dir.path() / "log";
}

void run_writer(const char* script, const std::vector<std::string>& arguments) {
  std::vector<std::string> command{
      KISSMAP_TEST_PYTHON, "-I", std::string(KISSMAP_CLIENT_SOURCES "/") + script};
  command.insert(command.end(), arguments.begin(), arguments.end());
  const ProgramResult written = run_program(command);
  ASSERT_EQ(written.exit_code, 0) << written.err;
}

class CutMcap : public testing::TestWithParam<const char*> {};

TEST_P(CutMcap, OfAnotherWriterGivesWhatCameBefore) {
  const TempDir dir;
  const fs::path file = dir.path() / "log.mcap";
  run_writer("write_ros2_bag.py", {write_folder(dir), file, std::string("mcap-") + GetParam()});
  expect_scans_before_cuts(file, "/points", scan_count);
}

INSTANTIATE_TEST_SUITE_P(Forms,
                         CutMcap,
                         testing::Values("none", "lz4", "zstd", "unchunked"),
                         [](const auto& form) { return std::string(form.param); });

TEST(CutContainers, OfOurMcapGiveWhatCameBefore) {
  const TempDir dir;
  const fs::path file = dir.path() / "log.mcap";
  const auto writer = open_scan_writer(file, ScanFormat::mcap);
  for (int k = 0; k < scan_count; ++k) writer->add(scan_number(k, 15'000));  // some chunks of 4 MB
  writer->finish();
  expect_scans_before_cuts(file, "/points", scan_count);
}

class CutRos1Bags : public testing::TestWithParam<const char*> {};

TEST_P(CutRos1Bags, GiveWhatCameBefore) {
  const ProgramResult import =
      run_program({KISSMAP_TEST_PYTHON, "-I", "-c", "import rosbag, nav_msgs.msg"});
  if (import.exit_code != 0) GTEST_SKIP() << "needs rosbag (python3-rosbag): " << import.err;
  const TempDir dir;
  const fs::path file = dir.path() / "log.bag";
  run_writer("write_ros1_bag.py", {write_folder(dir), file, GetParam(), "100000"});
  expect_scans_before_cuts(file, "/points", scan_count);
}

INSTANTIATE_TEST_SUITE_P(Forms,
                         CutRos1Bags,
                         testing::Values("none", "bz2", "lz4"),
                         [](const auto& form) { return std::string(form.param); });

/// A third of the scans, in the first file of a split bag.
fs::path write_db3(const TempDir& dir, const std::string& form) {
  run_writer("write_ros2_bag.py", {write_folder(dir), dir.path() / "bag", form});
  return dir.path() / "bag" / (form == "db3-file" ? "b_0.db3.zstd" : "b_0.db3");
}

class CutSqliteBags : public testing::TestWithParam<const char*> {};

TEST_P(CutSqliteBags, GiveWhatSqliteStillReads) {
  const TempDir dir;
  expect_scans_before_cuts(write_db3(dir, GetParam()), "/points", scan_count / 3);
}

INSTANTIATE_TEST_SUITE_P(Forms,
                         CutSqliteBags,
                         testing::Values("db3", "db3-message", "db3-file"),
                         [](const auto& form) {
                           std::string name = form.param;
                           std::ranges::replace(name, '-', '_');
                           return name;
                         });

TEST(CutContainers, PackedMcapGivesWhatCameBefore) {
  const TempDir dir;
  const fs::path file = dir.path() / "log.mcap";
  run_writer("write_ros2_bag.py", {write_folder(dir), file, "mcap-none"});
  run_program({KISSMAP_TEST_PYTHON,
               "-I",
               "-c",
               "import sys, zstandard; open(sys.argv[1] + '.zstd', 'wb').write("
               "zstandard.compress(open(sys.argv[1], 'rb').read()))",
               file});
  expect_scans_before_cuts(file.string() + ".zstd", "/points", scan_count);
}

TEST(CutContainers, OfARecordedBagGiveWhatCameBefore) {
  const char* data = std::getenv("KISSMAP_TEST_DATA");
  if (data == nullptr) GTEST_SKIP() << "needs the recordings";
  const fs::path file = fs::path(data) / "pointcloud2" / "hku1_60_pc2_lz4.bag";
  expect_scans_before_cuts(file, open_log(file)->info().topics.at(0).name, 60);
}

// Packets, of which the last sweep is begun.
TEST(CutContainers, OfARecordedSqliteBagGiveWhatCameBefore) {
  const char* data = std::getenv("KISSMAP_TEST_DATA");
  if (data == nullptr) GTEST_SKIP() << "needs the recordings";
  const fs::path file =
      fs::path(data) / "packets/velodyne/vlp16/1673400471837873222" / "1673400471837873222_0.db3";
  const auto log = open_log(file);
  const LogTopic& topic = log->info().topics.at(0);
  expect_scans_before_cuts(file, topic.name, *topic.message_count, [&](std::size_t messages) {
    const auto decoder = make_velodyne_decoder();
    for (const auto& packet : test::read_packet_bag(file, messages)) {
      decoder->add(packet.payload, packet.received_ns);
    }
    decoder->finish();
    std::vector<Scan> sweeps;
    while (auto scan = decoder->take()) sweeps.push_back(std::move(*scan));
    return sweeps;
  });
}

TEST(Containers, PassOverScansWithoutReadingThem) {
  const TempDir dir;
  const fs::path file = dir.path() / "whole.mcap";
  const auto writer = open_scan_writer(file, ScanFormat::mcap);
  for (int k = 0; k < scan_count; ++k) writer->add(scan_number(k));
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
