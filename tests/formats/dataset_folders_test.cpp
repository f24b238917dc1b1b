// SPDX-License-Identifier: MIT
// Which folders and files a path into a data set stands for, and what is told of them.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "formats/support.hpp"

namespace kissmap {
namespace {

using test::Bytes;
using test::error_of;
using test::read_all;
using test::scan_of;
using test::TempDir;
using testing::AllOf;
using testing::Contains;
using testing::HasSubstr;
using testing::Not;

// Seven rows: their bytes are a multiple of no other number of columns.
std::string rows(int columns) {
  Bytes bytes;
  for (int i = 0; i < 7 * columns; ++i) bytes.add<float>(1.0F + static_cast<float>(i));
  return bytes.text();
}

void write_boreas_rt(const TempDir& dir) {
  dir.write("seq/lidar/1606417097528152.bin", rows(6));
  dir.write("seq/aeva/1606417097478152.bin", rows(10));
  dir.write("seq/calib/T_applanix_lidar.txt", "0 -1 0 1.5\n1 0 0 -0.25\n0 0 1 0.13\n0 0 0 1\n");
}

TEST(BoreasRt, OfTwoLidarsOneIsChosen) {
  const TempDir dir;
  write_boreas_rt(dir);
  const auto seq = dir.path() / "seq";
  EXPECT_THAT(error_of(Fault::input, [&] { open_log(seq); }),
              AllOf(HasSubstr("--topic"), HasSubstr("\n  lidar"), HasSubstr("\n  aeva")));
  ReadOptions options;
  options.topic = "radar";
  EXPECT_THAT(error_of(Fault::usage, [&] { open_log(seq, options); }), HasSubstr("\n  aeva"));
  options.topic = "aeva";
  EXPECT_EQ(open_log(seq, options)->info().sensor, "Aeva Aeries II");
  options.topic = "lidar";
  const auto log = open_log(seq, options);
  EXPECT_EQ(log->info().sensor, "Velodyne VLS-128");
  EXPECT_EQ(read_all(*log)[0].name, "lidar/1606417097528152.bin");
}

TEST(BoreasRt, AFolderOfScansCanBeGivenItself) {
  const TempDir dir;
  write_boreas_rt(dir);
  for (const char* given : {"seq/aeva", "seq/aeva/", "seq/lidar/../aeva/."}) {
    const auto log = open_log(dir.path() / given);
    EXPECT_EQ(log->info().format, "boreas") << given;
    EXPECT_EQ(log->info().sensor, "Aeva Aeries II");
    EXPECT_EQ(read_all(*log)[0].name, "1606417097478152.bin");
  }
  EXPECT_EQ(open_log(dir.path() / "seq/lidar")->info().sensor, "Velodyne VLS-128");
  // Without a session around it, it is a folder like any other.
  dir.write("other/lidar/1606417097528152.bin", rows(6));
  EXPECT_EQ(open_log(dir.path() / "other/lidar")->info().format, "folder");
}

// A quarter turn to the left; the Aeva 2 m ahead of the lidar, turned like it.
TEST(BoreasRt, TheMountIsThatOfTheCalibration) {
  const TempDir dir;
  write_boreas_rt(dir);
  EXPECT_THAT(open_log(dir.path() / "seq/lidar")->info().notes,
              Contains(AllOf(HasSubstr("Applanix"),
                             HasSubstr(": 1.5,-0.25,0.13,0,0,0.707106781,0.707106781"))));
  EXPECT_THAT(open_log(dir.path() / "seq/aeva")->info().notes,
              Not(Contains(HasSubstr("Applanix"))));
  dir.write("seq/calib/T_aeva_lidar.txt", "1 0 0 -2\n0 1 0 0\n0 0 1 0\n0 0 0 1\n");
  EXPECT_THAT(open_log(dir.path() / "seq/aeva")->info().notes,
              Contains(HasSubstr(": 1.5,1.75,0.13,0,0,0.707106781,0.707106781")));
  dir.write("seq/calib/T_applanix_lidar.txt", "1 2 3\n");
  EXPECT_THAT(open_log(dir.path() / "seq/lidar")->info().notes,
              Not(Contains(HasSubstr("Applanix"))));
}

TEST(MulRanFolders, TheScansCanBeGivenThemselves) {
  const TempDir dir;
  dir.write("KAIST01/global_pose.csv", "");
  dir.write("KAIST01/Ouster/1561000444390857630.bin", rows(4));
  dir.write("player/sensor_data/Ouster/1561000444390857630.bin", rows(4));
  for (const char* given :
       {"KAIST01", "KAIST01/Ouster", "KAIST01/Ouster/", "player", "player/sensor_data/Ouster"}) {
    const auto log = open_log(dir.path() / given);
    EXPECT_EQ(log->info().format, "mulran") << given;
    EXPECT_EQ(scan_of(read_all(*log)[0]).points.size(), 7U);
    EXPECT_THAT(log->info().notes, Contains(HasSubstr(": 1.7042,-0.021,1.8047,")));
  }
  dir.write("HeLiPR/LiDAR/Ouster/1561000444390857630.bin", std::string(260, '\0'));
  EXPECT_EQ(open_log(dir.path() / "HeLiPR/LiDAR/Ouster")->info().format, "helipr");
  dir.write("alone/Ouster/1561000444390857630.bin", rows(4));
  EXPECT_EQ(open_log(dir.path() / "alone/Ouster")->info().format, "folder");
  EXPECT_EQ(open_log(dir.path() / "alone", {}, "mulran")->info().format, "mulran");
}

// 1000 records of 29 bytes, though the stamp tells 25; one of 25 that is right, one of neither.
TEST(HeliprAeva, RecordsOfTheOtherSizeAreCounted) {
  const TempDir dir;
  const std::string folder = "LiDAR/Aeva/";
  dir.write(folder + "1691936557746849179.bin", std::string(1001 * 29, '\1'));
  dir.write(folder + "1691936557846849179.bin", std::string(1001 * 25, '\1'));
  dir.write(folder + "1691936557946849179.bin", std::string(1001 * 25 + 3, '\1'));
  const auto log = open_log(dir.path());
  EXPECT_THAT(
      log->info().notes,
      Contains(AllOf(HasSubstr("1 of 3 files"), HasSubstr("LiDAR/Aeva/1691936557746849179.bin"))));
  const auto entries = read_all(*log);
  for (const LogEntry& entry : entries) EXPECT_EQ(scan_of(entry).points.size(), 1001U);
  std::filesystem::remove(dir.path() / folder / "1691936557746849179.bin");
  EXPECT_THAT(open_log(dir.path())->info().notes, Not(Contains(HasSubstr("take care"))));
}

void write_nuscenes(const TempDir& dir, const std::string& version) {
  dir.write(version + "/scene.json", R"([{"name": "scene-0061", "first_sample_token": "s"}])");
  dir.write(version + "/sample_data.json",
            R"([{"token": "d", "sample_token": "s", "next": "", "is_key_frame": true,
                 "calibrated_sensor_token": "c", "timestamp": 1533151603547590,
                 "filename": "samples/LIDAR_TOP/1.pcd.bin"}])");
  dir.write(version + "/calibrated_sensor.json",
            R"([{"token": "b", "rotation": [1, 0, 0, 0], "translation": [0, 0, 0]},
                {"token": "c", "rotation": [0, 0, 0, 1], "translation": [0.94, 0, 1.84]}])");
}

TEST(NuScenesFolders, OfSeveralVersionsOneIsGiven) {
  const TempDir dir;
  dir.write("samples/LIDAR_TOP/1.pcd.bin", rows(5));
  write_nuscenes(dir, "v1.0-mini");
  EXPECT_THAT(open_log(dir.path())->info().notes,
              Contains(AllOf(HasSubstr("ego"), HasSubstr(": 0.94,0,1.84,0,0,1,0"))));
  write_nuscenes(dir, "v1.0-trainval");
  EXPECT_THAT(
      error_of(Fault::input, [&] { open_log(dir.path()); }),
      AllOf(HasSubstr("several versions"), HasSubstr("v1.0-mini"), HasSubstr("v1.0-trainval")));
  for (const char* given : {"v1.0-mini", "v1.0-trainval/"}) {
    const auto log = open_log(dir.path() / given);
    EXPECT_EQ(log->info().format, "nuscenes");
    const auto entries = read_all(*log);
    ASSERT_EQ(entries.size(), 1U);
    EXPECT_EQ(entries[0].name, "samples/LIDAR_TOP/1.pcd.bin");
    EXPECT_EQ(scan_of(entries[0]).points.size(), 7U);
  }
}

TEST(NuScenesFolders, ABrokenMountIsToldAndTheScansAreRead) {
  const TempDir dir;
  dir.write("samples/LIDAR_TOP/1.pcd.bin", rows(5));
  write_nuscenes(dir, "v1.0-mini");
  dir.write("v1.0-mini/calibrated_sensor.json", R"([{"token": "c", "rotation": 5}])");
  const auto log = open_log(dir.path());
  EXPECT_THAT(log->info().notes, Contains(HasSubstr("calibrated_sensor.json")));
  EXPECT_EQ(read_all(*log).size(), 1U);
}

// As if they were counted from the first frame on: frame 12 would pass for 1.2 s late.
TEST(ParisLucoFolders, TimesBeginWithTheFrame) {
  const TempDir dir;
  std::string points;
  for (int i = 0; i < 200; ++i) points += "1 2 3 " + std::to_string(1.2 + 0.0005 * i) + "\n";
  dir.write("frames/frame_00012.ply",
            "ply\nformat ascii 1.0\nelement vertex 200\nproperty float x\nproperty float y\n"
            "property float z\nproperty float timestamp\nend_header\n" +
                points);
  dir.write("gt_traj_lidar.txt", "0 0 0\n");
  const auto entries = read_all(*open_log(dir.path()));
  const Scan& scan = scan_of(entries[0]);
  EXPECT_EQ(scan.stamp_ns, 1'200'000'000);
  EXPECT_EQ(scan.stamp_instant, StampInstant::sweep_start);
  EXPECT_NEAR(scan.time_offsets[0], 0.0F, 1e-6F);
  EXPECT_NEAR(scan.time_offsets[199], 0.0995F, 1e-6F);
}

}  // namespace
}  // namespace kissmap
