// SPDX-License-Identifier: MIT
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "formats/support.hpp"

namespace kissmap {
namespace {

using test::Bytes;
using test::error_of;
using test::read_all;
using test::refusal_of;
using test::scan_of;
using test::TempDir;
using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
namespace fs = std::filesystem;

std::string pcd(float x) {
  return "VERSION 0.7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\nWIDTH 1\nHEIGHT 1\n"
         "POINTS 1\nDATA binary\n" +
         Bytes().add<float>(x).add<float>(2).add<float>(3).text();
}

std::string ply(float x) {
  return "ply\nformat binary_big_endian 1.0\nelement vertex 1\nproperty float x\n"
         "property float y\nproperty float z\nend_header\n" +
         Bytes(std::endian::big).add<float>(x).add<float>(2).add<float>(3).text();
}

std::vector<std::string> names(const std::vector<LogEntry>& entries) {
  std::vector<std::string> result;
  for (const LogEntry& entry : entries) result.push_back(entry.name);
  return result;
}

std::vector<std::int64_t> stamps(const std::vector<LogEntry>& entries) {
  std::vector<std::int64_t> result;
  for (const LogEntry& entry : entries) result.push_back(scan_of(entry).stamp_ns);
  return result;
}

std::string error_at(const fs::path& path, const ReadOptions& options = {}) {
  return error_of(Fault::input, [&] { open_log(path, options); });
}

TEST(PointFolder, CountsScansInNaturalOrderWithoutStamps) {
  const TempDir dir;
  for (const char* name : {"10.ply", "9.ply", "1.ply", ".hidden.ply", "._9.ply", "notes.txt"}) {
    dir.write(name, ply(1));
  }
  const auto log = open_log(dir.path());
  EXPECT_EQ(log->info().stamp_source, "index");
  EXPECT_THAT(log->info().notes, Contains(HasSubstr("one second each")));
  const auto entries = read_all(*log);
  EXPECT_THAT(names(entries), ElementsAre("1.ply", "9.ply", "10.ply"));
  EXPECT_THAT(stamps(entries), ElementsAre(0, 1'000'000'000, 2'000'000'000));
  EXPECT_EQ(entries[2].index, 2U);
}

TEST(PointFolder, TakesStampsFromNames) {
  const TempDir dir;
  dir.write("cloud_1583836591_182590976.pcd", pcd(1));
  dir.write("cloud_1583836591_5.pcd", pcd(2));
  dir.write("times.txt", "not asked");
  const auto log = open_log(dir.path());
  EXPECT_EQ(log->info().stamp_source, "file names");
  EXPECT_THAT(stamps(read_all(*log)), ElementsAre(1583836591000000005, 1583836591182590976));
}

TEST(PointFolder, SortsFractionsByValue) {
  const TempDir dir;
  dir.write("12.5.pcd", pcd(1));
  dir.write("12.25.pcd", pcd(1));
  EXPECT_THAT(names(read_all(*open_log(dir.path()))), ElementsAre("12.25.pcd", "12.5.pcd"));
}

TEST(PointFolder, RefusesAStrayCopyAmongStamps) {
  const TempDir dir;
  dir.write("cloud_1583836591_5.pcd", pcd(1));
  dir.write("cloud_1583836591_6.pcd", pcd(1));
  dir.write("cloud_1583836591_6 (1).pcd", pcd(1));
  EXPECT_THAT(error_at(dir.path()), HasSubstr("2 names are stamps, 'cloud_1583836591_6 (1).pcd'"));
}

TEST(PointFolder, TakesStampsFromAFileBesideTheClouds) {
  for (const char* at : {"times.txt", "timestamps.txt", "scans/times.txt"}) {
    const TempDir dir;
    dir.write("scans/0.pcd", pcd(1));
    dir.write("scans/1.pcd", pcd(1));
    dir.write("labels/0.label", "");
    dir.write(at, "# seconds\n1700000000.000000001\r\n17.5e-1\n\n");
    const auto log = open_log(dir.path());
    EXPECT_EQ(log->info().stamp_source, fs::path(at).filename().string());
    EXPECT_THAT(stamps(read_all(*log)), ElementsAre(1700000000000000001, 1'750'000'000));
    EXPECT_THAT(names(read_all(*open_log(dir.path()))), ElementsAre("scans/0.pcd", "scans/1.pcd"));
    EXPECT_EQ(log->files()[0].name, at);
  }
}

TEST(PointFolder, DeliversEqualAndDecreasingStampsAsTheyAre) {
  const TempDir dir;
  for (const char* name : {"0.pcd", "1.pcd", "2.pcd"}) dir.write(name, pcd(1));
  dir.write("times.txt", "5\n5\n-1\n");
  EXPECT_THAT(stamps(read_all(*open_log(dir.path()))),
              ElementsAre(5'000'000'000, 5'000'000'000, -1'000'000'000));
}

TEST(PointFolder, RefusesStampFilesThatDoNotFit) {
  const TempDir dir;
  for (const char* name : {"0.pcd", "1.pcd"}) dir.write(name, pcd(1));
  dir.write("times.txt", "1\n");
  EXPECT_THAT(error_at(dir.path()), HasSubstr("times.txt: 1 stamps for 2 scans"));
  dir.write("times.txt", "1\n2\n3\n");
  EXPECT_THAT(error_at(dir.path()), HasSubstr("3 stamps for 2 scans"));
  dir.write("times.txt", "1\n\n3\n");
  EXPECT_THAT(error_at(dir.path()), HasSubstr("stamp 2 is a blank line"));
  dir.write("times.txt", "1\nnoon\n");
  EXPECT_THAT(error_at(dir.path()), HasSubstr("line 2: 'noon' is no stamp"));
}

TEST(PointFolder, RefusesMixedKindsListingThem) {
  const TempDir dir;
  dir.write("0.pcd", pcd(1));
  dir.write("1.ply", ply(1));
  dir.write("2.ply", ply(1));
  EXPECT_THAT(error_at(dir.path()), HasSubstr("several kinds: 1 .pcd, 2 .ply"));
  const TempDir foreign;
  foreign.write("0.pcd", pcd(1));
  foreign.write("1.las", "LASF");
  EXPECT_THAT(error_at(foreign.path()), HasSubstr("1 .las, 1 .pcd"));
}

TEST(PointFolder, RefusesSeveralSubfoldersListingThem) {
  const TempDir dir;
  dir.write("left/0.pcd", pcd(1));
  dir.write("right/0.pcd", pcd(1));
  EXPECT_THAT(error_at(dir.path()), HasSubstr("several folders hold clouds: left/ right/"));
}

TEST(PointFolder, GoesOnBehindFilesItCannotRead) {
  const TempDir dir;
  dir.write("0.ply", "");
  dir.write("1.ply", ply(1).substr(0, 100));
  dir.write("2.ply", pcd(1));
  dir.write("3.ply", "#ROSBAG V2.0\n");
  dir.write("4.ply", ply(4));
  fs::create_symlink("nowhere", dir.path() / "5.ply");
  const auto log = open_log(dir.path());
  EXPECT_EQ(log->info().scan_count, 6U);
  const auto entries = read_all(*log);
  ASSERT_EQ(entries.size(), 6U);
  EXPECT_EQ(refusal_of(entries[0]).reason, "empty file");
  EXPECT_EQ(refusal_of(entries[1]).reason, "truncated file");
  EXPECT_EQ(refusal_of(entries[2]).reason, "not what its name says");
  EXPECT_THAT(refusal_of(entries[2]).detail,
              HasSubstr("2.ply: named as PLY but begins like a PCD"));
  EXPECT_THAT(refusal_of(entries[3]).detail, HasSubstr("begins like a ROS bag"));
  EXPECT_EQ(scan_of(entries[4]).points[0].x(), 4.0F);
  EXPECT_EQ(scan_of(entries[4]).stamp_ns, 4'000'000'000);
  EXPECT_EQ(refusal_of(entries[5]).reason, "unreadable file");
}

TEST(PointFolder, DeliversAnAllNanScanWithoutPoints) {
  const TempDir dir;
  dir.write("0.ply", ply(std::nanf("")));
  dir.write("1.ply", ply(1));
  const auto entries = read_all(*open_log(dir.path()));
  EXPECT_EQ(scan_of(entries[0]).points.size(), 0U);
  EXPECT_EQ(scan_of(entries[0]).dropped.non_finite, 1U);
  EXPECT_EQ(scan_of(entries[1]).points.size(), 1U);
}

TEST(PointFolder, ReadsASingleFileOfAnyName) {
  const TempDir dir;
  const auto only = [&](const std::string& name, const std::string& content) {
    const auto log = open_log(dir.write(name, content));
    EXPECT_EQ(log->info().scan_count, 1U);
    return read_all(*log);
  };
  EXPECT_EQ(scan_of(only("a.PCD", pcd(1))[0]).points[0].x(), 1.0F);
  EXPECT_EQ(scan_of(only("b.txt", ply(2))[0]).points[0].x(), 2.0F);
  EXPECT_EQ(scan_of(only("1600000000123.pcd", pcd(1))[0]).stamp_ns, 1600000000123000000);
  dir.write("times.txt", "1\n2\n3\n");  // for the folder, not for one file of it
  EXPECT_EQ(scan_of(only("c.pcd", pcd(3))[0]).points[0].x(), 3.0F);
}

TEST(PointFolder, HashesWhatItHasRead) {
  const TempDir dir;
  dir.write("0.pcd", pcd(1));
  dir.write("1.pcd", pcd(1));
  dir.write("2.pcd", pcd(2));
  const auto log = open_log(dir.path());
  log->next();
  log->next();
  auto files = log->files();
  ASSERT_EQ(files.size(), 3U);
  EXPECT_EQ(files[0].xxh3.size(), 32U);
  EXPECT_EQ(files[0].xxh3, files[1].xxh3);
  EXPECT_EQ(files[2], (LogFile{"2.pcd", pcd(2).size(), ""}));
  log->next();
  EXPECT_NE(log->files()[2].xxh3, files[0].xxh3);
}

// Computed with the reference implementation's xxhsum -H2.
TEST(PointFolder, HashesLikeXxhsum) {
  const TempDir dir;
  const auto log = open_log(dir.write("0.pcd", ""));
  log->next();
  EXPECT_EQ(log->files()[0].xxh3, "99aa06d3014798d86001c324468d497f");
}

TEST(PointFolder, SkipsWithoutReading) {
  const TempDir dir;
  for (int i = 0; i < 5; ++i) dir.write(std::to_string(i) + ".pcd", pcd(1));
  const auto log = open_log(dir.path());
  log->skip(3);
  EXPECT_EQ(log->next()->index, 3U);
  EXPECT_EQ(log->files()[2].xxh3, "");
  log->skip(100);
  EXPECT_FALSE(log->next());
}

TEST(PointFolder, InfersTheWidthOfBinRows) {
  const TempDir dir;
  const auto rows = [](int count) {
    Bytes bytes;
    for (int i = 0; i < 5 * count; ++i) bytes.add<float>(static_cast<float>(i));
    return bytes.text();
  };
  dir.write("0.pcd.bin", rows(3));
  const auto log = open_log(dir.path());
  EXPECT_THAT(log->info().notes, Contains(HasSubstr("rows of 5 float32")));
  EXPECT_EQ(scan_of(*log->next()).points[2], Eigen::Vector3f(10, 11, 12));
  dir.write("0.pcd.bin", rows(4));  // 80 bytes: rows of 4 or of 5
  EXPECT_THAT(error_at(dir.path()), HasSubstr("--bin-columns"));
  ReadOptions options;
  options.bin_columns = 4;
  EXPECT_EQ(scan_of(*open_log(dir.path(), options)->next()).points.size(), 5U);
}

TEST(PointFolder, KeepsTheFirstUnitOfTimesForTheWholeLog) {
  const TempDir dir;
  const auto timed = [](int count, float span) {
    Bytes bytes;
    for (int i = 0; i < count; ++i) {
      bytes.add<float>(1).add<float>(1).add<float>(1).add<float>(span * static_cast<float>(i) /
                                                                 static_cast<float>(count - 1));
    }
    return "VERSION 0.7\nFIELDS x y z time\nSIZE 4 4 4 4\nTYPE F F F F\nWIDTH " +
           std::to_string(count) + "\nHEIGHT 1\nPOINTS " + std::to_string(count) +
           "\nDATA binary\n" + bytes.text();
  };
  dir.write("0.pcd", timed(500, 100.0F));
  dir.write("1.pcd", timed(5, 1.0F));
  const auto log = open_log(dir.path());
  EXPECT_THAT(log->info().notes, Contains(HasSubstr("field time, relative milliseconds")));
  const auto entries = read_all(*log);
  EXPECT_FLOAT_EQ(scan_of(entries[0]).time_offsets.back(), 0.1F);
  EXPECT_FLOAT_EQ(scan_of(entries[1]).time_offsets.back(), 0.001F);
}

TEST(PointFolder, RefusesScansWithoutTheTimeFieldAskedFor) {
  const TempDir dir;
  dir.write("0.pcd", pcd(1));
  ReadOptions options;
  options.time_field = "gps_time";
  const auto entries = read_all(*open_log(dir.path(), options));
  EXPECT_EQ(refusal_of(entries[0]).reason, "time field not found");
  EXPECT_THAT(refusal_of(entries[0]).detail, HasSubstr("fields: x y z"));
}

}  // namespace
}  // namespace kissmap
