// SPDX-License-Identifier: MIT
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

#include "formats/logs/kitti_calibration.hpp"
#include "formats/logs/kitti_scans.hpp"
#include "formats/support.hpp"
#include "support/matchers.hpp"

namespace kissmap {
namespace {

using test::Bytes;
using test::error_of;
using test::read_all;
using test::refusal_of;
using test::scan_of;
using test::TempDir;
namespace fs = std::filesystem;
using testing::HasSubstr;

std::string scan_bytes(std::initializer_list<Eigen::Vector3f> points) {
  Bytes bytes;
  for (const Eigen::Vector3f& p : points) {
    bytes.add<float>(p.x()).add<float>(p.y()).add<float>(p.z()).add<float>(0.25F);
  }
  return bytes.text();
}

const char* const calib =
    "P0: 718.856 0 607.1928 0 0 718.856 185.2157 0 0 0 1 0\n"
    "calib_time: 09-Jan-2012 13:57:47\n"
    "Tr: 0 -1 0 -0.01 0 0 -1 -0.08 1 0 0 -0.27\n";

/// sequences/04 as KITTI odometry has it, with the labels and poses of SemanticKITTI.
void write_sequence(const TempDir& dir, const std::string& at = "sequences/04/") {
  dir.write(at + "velodyne/000000.bin", scan_bytes({{10, 0, 0}, {0, 0, 5}, {0, 0, 0}}));
  dir.write(at + "velodyne/000001.bin", scan_bytes({{0, -20, 1}}));
  dir.write(at + "times.txt", "0.000000e+00\n1.036224e-01\n");
  dir.write(at + "calib.txt", calib);
  dir.write(at + "poses.txt", "1 0 0 0 0 1 0 0 0 0 1 0\n");
  dir.write(at + "labels/000000.label", std::string(12, '\0'));
}

TEST(KittiCorrection, RaisesByTheKnownAngle) {
  const Eigen::Vector3f raised = raised_by_kitti_correction({10, 0, 0});
  EXPECT_NEAR(raised.x(), 9.999936, 1e-6);
  EXPECT_EQ(raised.y(), 0.0F);
  EXPECT_NEAR(raised.z(), 0.0357792, 1e-7);
}

TEST(KittiCorrection, KeepsRangeAndAzimuth) {
  std::mt19937 random(1);
  std::uniform_real_distribution<float> coordinate(-60.0F, 60.0F);
  for (int i = 0; i < 1000; ++i) {
    const Eigen::Vector3f p(coordinate(random), coordinate(random), coordinate(random));
    const Eigen::Vector3f q = raised_by_kitti_correction(p);
    EXPECT_NEAR(q.norm(), p.norm(), 1e-5 * p.norm());
    EXPECT_NEAR(std::atan2(q.y(), q.x()), std::atan2(p.y(), p.x()), 1e-6);
    const double raise = std::asin(q.z() / q.norm()) - std::asin(p.z() / p.norm());
    EXPECT_NEAR(raise, 0.205 * std::numbers::pi / 180.0, 2e-6);
  }
}

TEST(KittiCorrection, LeavesPointsOnTheAxis) {
  EXPECT_EQ(raised_by_kitti_correction({0, 0, 7}), Eigen::Vector3f(0, 0, 7));
  EXPECT_EQ(raised_by_kitti_correction({0, 0, -7}), Eigen::Vector3f(0, 0, -7));
}

TEST(KittiSweep, TurnsClockwiseFromTheRear) {
  EXPECT_DOUBLE_EQ(kitti_sweep_fraction({1, 0, 0}), 0.5);
  EXPECT_DOUBLE_EQ(kitti_sweep_fraction({0, 1, 0}), 0.25);
  EXPECT_DOUBLE_EQ(kitti_sweep_fraction({0, -1, 0}), 0.75);
}

// KITTI odometry is compensated already and has no times (trap 1), and is too low (trap 2).
TEST(KittiOdometry, ReadsASequence) {
  const TempDir dir;
  write_sequence(dir);
  const auto log = open_log(dir.path() / "sequences/04");
  EXPECT_EQ(log->info().format, "kitti");
  EXPECT_EQ(log->info().stamp_source, "times.txt");
  EXPECT_EQ(log->info().scan_count, 2U);
  const auto entries = read_all(*log);
  ASSERT_EQ(entries.size(), 2U);
  EXPECT_EQ(entries[1].name, "velodyne/000001.bin");
  const Scan& first = scan_of(entries[0]);
  EXPECT_EQ(first.compensation, Compensation::yes);
  EXPECT_EQ(first.time_source, TimeSource::none);
  EXPECT_EQ(first.dropped.zero, 1U);
  EXPECT_NEAR(first.points[0].z(), 0.0357792, 1e-7);
  EXPECT_EQ(first.points[1], Eigen::Vector3f(0, 0, 5));
  EXPECT_EQ(scan_of(entries[1]).stamp_ns, 103'622'400);
  EXPECT_THAT(scan_of(entries[1]).intensities, testing::ElementsAre(0.25F));
}

TEST(KittiOdometry, LeavesTheCorrectionToTheUser) {
  const TempDir dir;
  write_sequence(dir);
  ReadOptions options;
  options.kitti_elevation_correction = false;
  const auto log = open_log(dir.path() / "sequences/04", options);
  EXPECT_EQ(scan_of(*log->next()).points[0], Eigen::Vector3f(10, 0, 0));
  EXPECT_THAT(log->info().notes, testing::Contains(HasSubstr("not raised by 0.205")));
}

TEST(KittiOdometry, MayBeNamedByItsRootOrItsVelodyneFolder) {
  const TempDir dir;
  write_sequence(dir);
  for (const char* path : {"", "sequences/04", "sequences/04/", "sequences/04/velodyne"}) {
    const auto log = open_log(dir.path() / path);
    EXPECT_EQ(log->info().format, "kitti") << path;
    EXPECT_EQ(log->info().stamp_source, "times.txt") << path;
  }
  write_sequence(dir, "sequences/07/");
  const std::string error = error_of(Fault::input, [&] { open_log(dir.path()); });
  EXPECT_THAT(error, HasSubstr("several sequences: 04 07"));
}

TEST(KittiOdometry, StampsAScanByTheNumberInItsName) {
  const TempDir dir;
  write_sequence(dir);
  fs::rename(dir.path() / "sequences/04/velodyne/000001.bin",
             dir.path() / "sequences/04/velodyne/000002.bin");
  dir.write("sequences/04/times.txt", "0\n0.1\n0.2\n");
  const auto log = open_log(dir.path());
  EXPECT_EQ(scan_of(read_all(*log)[1]).stamp_ns, 200'000'000);
  EXPECT_THAT(log->info().notes, testing::Contains(HasSubstr("1 stamps without a scan")));
}

TEST(KittiOdometry, TakesAsManyStampsInOrderWhenNamesAreNoLines) {
  const TempDir dir;
  write_sequence(dir);
  for (const char* name : {"000000.bin", "000001.bin"}) {
    fs::rename(dir.path() / "sequences/04/velodyne" / name,
               dir.path() / "sequences/04/velodyne" / ("cut_" + std::string(name)));
  }
  EXPECT_EQ(scan_of(read_all(*open_log(dir.path()))[1]).stamp_ns, 103'622'400);
  dir.write("sequences/04/times.txt", "0\n0.1\n0.2\n");
  const std::string error = error_of(Fault::input, [&] { open_log(dir.path()); });
  EXPECT_THAT(error, HasSubstr("times.txt: 3 stamps for 2 scans"));
}

TEST(KittiOdometry, CountsScansWithoutTimes) {
  const TempDir dir;
  write_sequence(dir);
  fs::remove(dir.path() / "sequences/04/times.txt");
  const auto log = open_log(dir.path());
  EXPECT_EQ(log->info().stamp_source, "index");
  EXPECT_EQ(scan_of(read_all(*log)[1]).stamp_ns, 100'000'000);
}

TEST(KittiOdometry, RefusesATruncatedScanAndGoesOn) {
  const TempDir dir;
  write_sequence(dir);
  dir.write("sequences/04/velodyne/000000.bin", std::string(1234567, 'a'));
  const auto entries = read_all(*open_log(dir.path()));
  EXPECT_EQ(refusal_of(entries[0]).reason, "wrong file size");
  EXPECT_THAT(refusal_of(entries[0]).detail, HasSubstr("000000.bin: 1234567 bytes"));
  EXPECT_EQ(scan_of(entries[1]).points.size(), 1U);
}

TEST(KittiCalibration, IsThePoseOfTheLidarInCamera0) {
  const TempDir dir;
  const Rigid3 cam0_from_lidar = read_kitti_cam0_from_lidar(dir.write("calib.txt", calib));
  // Forward of the lidar is the optical axis; left is -x, up is -y.
  EXPECT_TRUE((cam0_from_lidar * Eigen::Vector3d(10, 1, 2))
                  .isApprox(Eigen::Vector3d(-1.01, -2.08, 9.73), 1e-12));
  const auto error = [&](const char* text) {
    return error_of(Fault::input,
                    [&] { read_kitti_cam0_from_lidar(dir.write("calib.txt", text)); });
  };
  EXPECT_THAT(error("P0: 1\n"), HasSubstr("no line 'Tr:'"));
  EXPECT_THAT(error("\nTr: 1 0 0 nan"), HasSubstr("line 2: 'nan'"));
  EXPECT_THAT(error("Tr: 1 0 0"), HasSubstr("line 1: ''"));
}

void write_drive(const TempDir& dir) {
  const std::string at = "velodyne_points/";
  for (const char* number : {"0000000000", "0000000001", "0000000003"}) {
    dir.write(at + "data/" + number + ".bin",
              scan_bytes({{10, 0, 0}, {0, 10, 0}, {0, -10, 0}, {-10, -0.0F, 0}}));
  }
  // Scan 2 is missing: its lines are empty (trap 19).
  dir.write(at + "timestamps.txt",
            "2011-09-26 13:02:25.050000000\n2011-09-26 13:02:25.150000000\n\n"
            "2011-09-26 13:02:25.350000000\n");
  dir.write(at + "timestamps_start.txt",
            "2011-09-26 13:02:25.000000000\n2011-09-26 13:02:25.110000000\n\n"
            "2011-09-26 13:02:25.300000000\n");
  dir.write(at + "timestamps_end.txt",
            "2011-09-26 13:02:25.100000000\n2011-09-26 13:02:25.190000000\n\n"
            "2011-09-26 13:02:25.400000000\n");
  dir.write("oxts/timestamps.txt", "2011-09-26 13:02:25.0\n");
}

TEST(KittiRaw, PairsScansWithLinesByNumber) {
  const TempDir dir;
  write_drive(dir);
  const auto log = open_log(dir.path());
  EXPECT_EQ(log->info().format, "kitti-raw");
  const auto entries = read_all(*log);
  ASSERT_EQ(entries.size(), 3U);
  EXPECT_EQ(entries[2].name, "velodyne_points/data/0000000003.bin");
  EXPECT_EQ(scan_of(entries[2]).stamp_ns - scan_of(entries[0]).stamp_ns, 300'000'000);
  EXPECT_EQ(scan_of(entries[0]).stamp_ns, 1'317'042'145'050'000'000);
}

TEST(KittiRaw, DerivesTimesFromAzimuth) {
  const TempDir dir;
  write_drive(dir);
  const auto entries = read_all(*open_log(dir.path()));
  const Scan& scan = scan_of(entries[1]);  // a sweep of 0.08 s from -0.04 s
  EXPECT_EQ(scan.compensation, Compensation::no);
  EXPECT_EQ(scan.time_source, TimeSource::derived);
  EXPECT_EQ(scan.stamp_instant, StampInstant::sweep_middle);
  EXPECT_THAT(scan.time_offsets,
              testing::Pointwise(testing::FloatNear(1e-6F), {0.0F, -0.02F, 0.02F, 0.04F}));
  EXPECT_EQ(scan.points[0], Eigen::Vector3f(10, 0, 0));  // no correction of elevations here
}

TEST(KittiRaw, LeavesTimesAwayWhenAsked) {
  const TempDir dir;
  write_drive(dir);
  ReadOptions options;
  options.time_unit = "none";
  const auto log = open_log(dir.path(), options);
  const auto entry = log->next();
  EXPECT_EQ(scan_of(*entry).time_source, TimeSource::none);
}

TEST(KittiRaw, RefusesAScanWithoutItsStamp) {
  const TempDir dir;
  write_drive(dir);
  dir.write("velodyne_points/data/0000000002.bin", scan_bytes({{1, 0, 0}}));
  dir.write("velodyne_points/data/0000000099.bin", scan_bytes({{1, 0, 0}}));
  const auto entries = read_all(*open_log(dir.path()));
  ASSERT_EQ(entries.size(), 5U);
  EXPECT_EQ(refusal_of(entries[2]).reason, "no stamp");
  EXPECT_EQ(refusal_of(entries[4]).reason, "no stamp");
  EXPECT_EQ(scan_of(entries[3]).points.size(), 4U);
}

TEST(KittiRaw, SaysWhatIsWrong) {
  const TempDir dir;
  write_drive(dir);
  dir.write("velodyne_points/timestamps.txt", "2011-09-26 13:02:25.05\nyesterday\n");
  EXPECT_THAT(error_of(Fault::input, [&] { open_log(dir.path()); }),
              HasSubstr("timestamps.txt: line 2: 'yesterday' is no stamp"));
  const TempDir other;
  write_drive(other);
  other.write("velodyne_points/data/first.bin", "");
  EXPECT_THAT(error_of(Fault::input, [&] { open_log(other.path()); }),
              HasSubstr("the name is no scan number"));
}

TEST(KittiRaw, AssumesATenthOfASecondWithoutSweepTimes) {
  const TempDir dir;
  write_drive(dir);
  fs::remove(dir.path() / "velodyne_points/timestamps_end.txt");
  const auto log = open_log(dir.path());
  EXPECT_THAT(log->info().notes, testing::Contains(HasSubstr("sweeps of 0.1 s")));
  EXPECT_NEAR(scan_of(*log->next()).time_offsets[2], 0.025, 1e-6);
}

}  // namespace
}  // namespace kissmap
