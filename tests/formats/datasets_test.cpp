// SPDX-License-Identifier: MIT
// Data sets written byte by byte as their owners' tools read them.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "formats/dataset_scans.hpp"

namespace kissmap {
namespace {

using test::Bytes;
using test::entries_of;
using test::error_of;
using test::only_scan;
using test::read_all;
using test::scan_of;
using test::TempDir;
using testing::HasSubstr;

// 64 x 1024 rows, the point of index i at (1 + ring, 2 + column, 3).
std::string mulran_scan(std::size_t points) {
  Bytes bytes;
  for (std::size_t i = 0; i < points; ++i) {
    bytes.add<float>(1.0F + static_cast<float>(i % 64));
    bytes.add<float>(2.0F + static_cast<float>(i / 64));
    bytes.add<float>(3.0F).add<float>(7.0F);
  }
  return bytes.text();
}

TEST(MulRan, PointsAreColumnByColumn) {
  const TempDir dir;
  dir.write("global_pose.csv", "");
  dir.write("Ouster/1561000444390857630.bin", mulran_scan(65536));
  const Scan scan = only_scan(dir.path(), "mulran");
  EXPECT_EQ(scan.stamp_ns, 1561000444390857630);
  ASSERT_EQ(scan.points.size(), 65536U);
  EXPECT_EQ(scan.time_source, TimeSource::derived);
  // Point 130 lies in ring 2 of column 2.
  EXPECT_EQ(scan.points[130], Eigen::Vector3f(3, 4, 3));
  EXPECT_FLOAT_EQ(scan.time_offsets[130], static_cast<float>(2.0 / 1024 * 0.1));
  EXPECT_EQ(scan.time_offsets[0], 0.0F);
}

TEST(MulRan, MissingReturnsTakeTheirTimesAlong) {
  const TempDir dir;
  dir.write("data_stamp.csv", "");
  std::string content = mulran_scan(65536);
  std::fill_n(content.begin(), 64 * 16, '\0');  // nothing came back in the first column
  dir.write("Ouster/1561000444390857630.bin", content);
  const Scan scan = only_scan(dir.path(), "mulran");
  ASSERT_EQ(scan.points.size(), 65472U);
  EXPECT_EQ(scan.dropped.zero, 64U);
  EXPECT_FLOAT_EQ(scan.time_offsets[0], static_cast<float>(1.0 / 1024 * 0.1));
}

TEST(MulRan, CutScansHavePointsButNoTimes) {
  const TempDir dir;
  dir.write("global_pose.csv", "");
  dir.write("Ouster/1561000444390857630.bin", mulran_scan(1000) + "rest");
  dir.write("Ouster/1561000444490857630.bin", "");
  const auto entries = entries_of(dir.path(), "mulran");
  ASSERT_EQ(entries.size(), 2U);
  EXPECT_EQ(scan_of(entries[0]).points.size(), 1000U);
  EXPECT_EQ(scan_of(entries[0]).time_source, TimeSource::none);
  EXPECT_EQ(test::refusal_of(entries[1]).reason, "empty file");
}

struct HeliprCase {
  std::string sensor;
  std::string stamp;
  std::size_t record;
  std::size_t time_at;
  char time_type;  // u: uint32 ns, f: float s, i: int32 ns
};

class Helipr : public testing::TestWithParam<HeliprCase> {};

// 1000 points and half a record behind them.
TEST_P(Helipr, ReadsPackedRecords) {
  const HeliprCase& c = GetParam();
  std::string content;
  for (int i = 0; i < 1000; ++i) {
    std::string point =
        Bytes().add<float>(1.0F + static_cast<float>(i)).add<float>(2).add<float>(3).text();
    point.resize(c.record, '\0');
    Bytes time;
    if (c.time_type == 'u') time.add<std::uint32_t>(static_cast<std::uint32_t>(i) * 100'000);
    if (c.time_type == 'i') time.add<std::int32_t>(i * 100'000);
    if (c.time_type == 'f') time.add<float>(static_cast<float>(i) * 1e-4F);
    point.replace(c.time_at, 4, time.text());
    content += point;
  }
  EXPECT_EQ(content.size(), 1000 * c.record);
  const TempDir dir;
  const std::string folder = "LiDAR/" + c.sensor;
  dir.write(folder + "/" + c.stamp + ".bin", content);
  for (const auto& path : {dir.path(), dir.path() / folder}) {
    const Scan scan = only_scan(path, "helipr");
    EXPECT_EQ(std::to_string(scan.stamp_ns), c.stamp);
    ASSERT_EQ(scan.points.size(), 1000U);
    EXPECT_EQ(scan.points[999], Eigen::Vector3f(1000, 2, 3));
    ASSERT_EQ(scan.time_offsets.size(), 1000U);
    EXPECT_NEAR(scan.time_offsets[999], 0.0999, 1e-6);
    EXPECT_EQ(scan.time_source, TimeSource::recorded);
  }
  dir.write(folder + "/" + c.stamp + ".bin", content.substr(0, content.size() - c.record / 2));
  EXPECT_EQ(only_scan(dir.path(), "helipr").points.size(), 999U);
}

INSTANTIATE_TEST_SUITE_P(Sensors,
                         Helipr,
                         testing::Values(HeliprCase{"Ouster", "1691936557946849179", 26, 16, 'u'},
                                         HeliprCase{"Velodyne", "1691936557946849179", 22, 18, 'f'},
                                         HeliprCase{"Avia", "1691936557946849179", 19, 15, 'u'},
                                         HeliprCase{"Aeva", "1691936557946849179", 25, 20, 'i'},
                                         HeliprCase{"Aeva", "1691936557946849180", 29, 20, 'i'}),
                         [](const auto& c) {
                           return c.param.sensor + std::to_string(c.param.record);
                         });

TEST(HeliprFolder, OfSeveralSensorsAsksForOne) {
  const TempDir dir;
  dir.write("LiDAR/Avia/1691936557946849179.bin", "");
  dir.write("LiDAR/Aeva/1691936557946849179.bin", "");
  EXPECT_THAT(error_of(Fault::input, [&] { open_log(dir.path()); }),
              testing::AllOf(HasSubstr("several sensors"), HasSubstr("LiDAR/Avia")));
}

std::string pcd(std::size_t points) {
  const std::string count = std::to_string(points);
  Bytes bytes;
  for (std::size_t i = 0; i < points; ++i) {
    bytes.add<float>(1.0F + static_cast<float>(i % 64)).add<float>(2).add<float>(3);
  }
  return "VERSION 0.7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\nWIDTH " + count +
         "\nHEIGHT 1\nPOINTS " + count + "\nDATA binary\n" + bytes.text();
}

TEST(NewerCollege, NanosecondsInNamesAreNotPadded) {
  const TempDir dir;
  const std::string folder = "raw_format/ouster_scan/";
  dir.write(folder + "cloud_1583836591_182590976.pcd", pcd(10));
  dir.write(folder + "cloud_1583836591_5.pcd", pcd(65536));
  const auto entries = entries_of(dir.path(), "newer-college");
  ASSERT_EQ(entries.size(), 2U);
  EXPECT_EQ(scan_of(entries[0]).stamp_ns, 1583836591000000005);
  EXPECT_EQ(scan_of(entries[1]).stamp_ns, 1583836591182590976);
  EXPECT_FLOAT_EQ(scan_of(entries[0]).time_offsets[130], static_cast<float>(2.0 / 1024 * 0.1));
  EXPECT_EQ(scan_of(entries[1]).time_source, TimeSource::none);
}

TEST(Apollo, ScansAreCountedFromOneAndNotPadded) {
  const TempDir dir;
  for (const int k : {1, 2, 10}) dir.write("pcds/" + std::to_string(k) + ".pcd", pcd(5));
  dir.write("pcds/11.pcd", pcd(5));
  dir.write("poses/gt_poses.txt",
            "1 100.5 0 0 0 0 0 0 1\n2 100.6 0 0 0 0 0 0 1\n10 101.4 0 0 0 0 0 0 1\n");
  const auto entries = entries_of(dir.path(), "apollo");
  ASSERT_EQ(entries.size(), 4U);
  EXPECT_EQ(entries[2].name, "pcds/10.pcd");
  EXPECT_EQ(scan_of(entries[1]).stamp_ns, 100'600'000'000);
  EXPECT_EQ(scan_of(entries[2]).stamp_ns, 101'400'000'000);
  EXPECT_EQ(test::refusal_of(entries[3]).reason, "no stamp");
}

TEST(Boreas, StampIsTheMiddleAndTimesAreRelativeToIt) {
  const TempDir dir;
  dir.write("applanix/lidar_poses.csv", "");
  Bytes bytes;
  for (int i = 0; i < 200; ++i) {
    bytes.add<float>(1.0F + static_cast<float>(i)).add<float>(2).add<float>(3).add<float>(4);
    bytes.add<float>(5).add<float>(-0.05F + static_cast<float>(i) * 0.0005F);
  }
  dir.write("lidar/1606417097528152.bin", bytes.text());
  const Scan scan = only_scan(dir.path(), "boreas");
  EXPECT_EQ(scan.stamp_ns, 1606417097528152000);
  EXPECT_EQ(scan.stamp_instant, StampInstant::sweep_middle);
  EXPECT_EQ(scan.compensation, Compensation::no);
  ASSERT_EQ(scan.time_offsets.size(), 200U);
  EXPECT_NEAR(scan.time_offsets[0], -0.05F, 1e-6F);
}

TEST(Boreas, AevaRecordsHaveFortyBytes) {
  const TempDir dir;
  dir.write("calib/T_applanix_lidar.txt", "");
  std::string content;
  for (int i = 0; i < 200; ++i) {
    Bytes bytes;
    bytes.add<float>(1.0F + static_cast<float>(i)).add<float>(2).add<float>(3).add<float>(0.5F);
    bytes.add<float>(11).add<float>(1).add<float>(1).add<float>(static_cast<float>(i) * 5e-4F);
    content += bytes.add<std::uint64_t>(0).text();
  }
  dir.write("aeva/1606417097528152.bin", content);
  const Scan scan = only_scan(dir.path(), "boreas");
  ASSERT_EQ(scan.points.size(), 200U);
  EXPECT_EQ(scan.intensities[3], 11.0F);
  EXPECT_EQ(scan.stamp_instant, StampInstant::sweep_start);
  EXPECT_NEAR(scan.time_offsets[199], 0.0995F, 1e-6F);
}

TEST(ParisLuco, FramesAreATenthOfASecondApart) {
  const TempDir dir;
  std::string rows;
  for (int i = 0; i < 200; ++i) rows += "1 2 3 " + std::to_string(0.0005 * i) + "\n";
  const std::string head =
      "ply\nformat ascii 1.0\nelement vertex 200\nproperty float x\nproperty float y\n"
      "property float z\nproperty double timestamp\nend_header\n";
  dir.write("frames/frame_00000.ply", head + rows);
  dir.write("frames/frame_00012.ply", head + rows);
  dir.write("gt_traj_lidar.txt", "0 0 0\n");
  const auto entries = entries_of(dir.path(), "paris-luco");
  ASSERT_EQ(entries.size(), 2U);
  EXPECT_EQ(scan_of(entries[1]).stamp_ns, 1'200'000'000);
  EXPECT_NEAR(scan_of(entries[1]).time_offsets[199], 0.0995F, 1e-6F);
}

// Two scenes; the second has a sample, a sweep and a sample, and a camera between them.
TempDir& write_nuscenes(TempDir& dir) {
  const std::string tables = "v1.0-mini/";
  dir.write(tables + "scene.json",
            R"([{"name": "scene-0061", "first_sample_token": "a"},
                {"name": "scene-0103", "first_sample_token": "s1"}])");
  dir.write(tables + "sample_data.json",
            R"([{"token": "d3", "sample_token": "s2", "next": "", "is_key_frame": true,
                 "timestamp": 1533151603647590, "filename": "samples/LIDAR_TOP/3.pcd.bin"},
                {"token": "d1", "sample_token": "s1", "next": "d2", "is_key_frame": true,
                 "timestamp": 1533151603547590, "filename": "samples/LIDAR_TOP/1.pcd.bin"},
                {"token": "c1", "sample_token": "s1", "next": "", "is_key_frame": true,
                 "timestamp": 1533151603512404, "filename": "samples/CAM_FRONT/1.jpg"},
                {"token": "d2", "sample_token": "s2", "next": "d3", "is_key_frame": false,
                 "timestamp": 1533151603597590, "filename": "sweeps/LIDAR_TOP/2.pcd.bin"}])");
  int k = 0;
  for (const char* file : {"samples/LIDAR_TOP/1", "sweeps/LIDAR_TOP/2", "samples/LIDAR_TOP/3"}) {
    Bytes bytes;
    bytes.add<float>(1.0F + static_cast<float>(k++))
        .add<float>(2)
        .add<float>(3)
        .add<float>(4)
        .add<float>(5);
    dir.write(std::string(file) + ".pcd.bin", bytes.text());
  }
  return dir;
}

TEST(NuScenes, FollowsTheScansOfOneSceneThroughTheTables) {
  TempDir dir;
  ReadOptions options;
  options.topic = "scene-0103";
  const auto log = open_log(write_nuscenes(dir).path(), options);
  EXPECT_EQ(log->info().format, "nuscenes");
  const auto entries = read_all(*log);
  ASSERT_EQ(entries.size(), 3U);
  EXPECT_EQ(entries[1].name, "sweeps/LIDAR_TOP/2.pcd.bin");
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_EQ(scan_of(entries[i]).points[0], Eigen::Vector3f(1.0F + static_cast<float>(i), 2, 3));
    EXPECT_EQ(scan_of(entries[i]).stamp_ns,
              1533151603547590000 + static_cast<std::int64_t>(i) * 50'000'000);
    EXPECT_EQ(scan_of(entries[i]).stamp_instant, StampInstant::sweep_end);
  }
}

TEST(NuScenes, AsksWhichSceneAndNamesBrokenTables) {
  TempDir dir;
  write_nuscenes(dir);
  EXPECT_THAT(
      error_of(Fault::input, [&] { open_log(dir.path()); }),
      testing::AllOf(HasSubstr("--topic"), HasSubstr("scene-0061"), HasSubstr("scene-0103")));
  dir.write("v1.0-mini/scene.json", "[{\"name\": 5}]");
  EXPECT_THAT(error_of(Fault::input, [&] { open_log(dir.path()); }), HasSubstr("v1.0-mini"));
  dir.write("v1.0-mini/scene.json", "[{\"name\": ");
  EXPECT_THAT(error_of(Fault::input, [&] { open_log(dir.path()); }), HasSubstr("scene.json"));
}

}  // namespace
}  // namespace kissmap
