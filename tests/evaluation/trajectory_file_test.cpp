// SPDX-License-Identifier: MIT
#include "kissmap/formats/trajectory_file.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <numbers>

#include "evaluation/files.hpp"
#include "kissmap/error.hpp"
#include "support/matchers.hpp"
#include "support/random_walk.hpp"
#include "support/temp_dir.hpp"

namespace kissmap {
namespace {

using testing::AllOf;
using testing::HasSubstr;

class ReadTrajectory : public testing::Test {
 protected:
  std::filesystem::path file(const std::string& text, const std::string& name = "file") const {
    return write_text(temp_.path() / name, text);
  }
  std::string error_of(const std::string& text, const std::string& times = "") const {
    try {
      read_trajectory(file(text), times.empty() ? std::filesystem::path{} : file(times, "times"));
    } catch (const Error& error) {
      EXPECT_EQ(error.fault(), Fault::input);
      return error.what();
    }
    return "no error";
  }
  TempDir temp_;
};

TEST_F(ReadTrajectory, TumRoundTrip) {
  const std::vector<Rigid3> way = winding_way(50, 0.7, 1.0);
  const TrajectoryFile read = read_trajectory(file(tum_text(way)));
  EXPECT_EQ(read.format, "TUM");
  ASSERT_EQ(read.trajectory.size(), way.size());
  for (std::size_t i = 0; i < way.size(); ++i) {
    EXPECT_THAT(read.trajectory.poses[i], PoseNear(way[i], 0.0, 1e-15));
  }
  EXPECT_EQ(read.trajectory.stamps_ns[3], 1'700'000'000'300'000'000);
}

TEST_F(ReadTrajectory, KittiRoundTripWithAndWithoutTimes) {
  const std::vector<Rigid3> way = winding_way(3, 0.7, 1.0);
  const auto poses = file(kitti_text(way));
  EXPECT_FALSE(read_trajectory(poses).trajectory.has_stamps());
  const TrajectoryFile read =
      read_trajectory(poses, file("0.000000e+00\n1.036224e-01\n2.072e-01\n", "times"));
  EXPECT_EQ(read.format, "KITTI");
  EXPECT_EQ(read.trajectory.stamps_ns, (std::vector<std::int64_t>{0, 103'622'400, 207'200'000}));
  for (std::size_t i = 0; i < way.size(); ++i) {
    EXPECT_THAT(read.trajectory.poses[i], PoseNear(way[i], 0.0, 1e-14));
  }
}

TEST_F(ReadTrajectory, MulRanIsTakenFromTheBaseToTheLidar) {
  const TrajectoryFile read =
      read_trajectory(file("1561000444390857630,1,0,0,0,0,1,0,0,0,0,1,0\n1561000444490857630,0,-1,"
                           "0,10,1,0,0,0,0,0,1,0\n"));
  EXPECT_EQ(read.format, "MulRan");
  ASSERT_EQ(read.trajectory.size(), 2U);
  EXPECT_EQ(read.trajectory.stamps_ns[0], 1561000444390857630);
  const Rigid3 motion = read.trajectory.poses[0].inverse() * read.trajectory.poses[1];
  EXPECT_NEAR(motion.translation.x(), -8.3066, 1e-4);
  EXPECT_NEAR(motion.translation.y(), -1.7737, 1e-4);
  EXPECT_NEAR(motion.angle(), std::numbers::pi / 2, 1e-4);
}

TEST_F(ReadTrajectory, HeliprHasNanosecondsInTumsColumns) {
  const TrajectoryFile read = read_trajectory(file("1691936557946849179 1 2 3 0 0 0 1\n"));
  EXPECT_EQ(read.trajectory.stamps_ns[0], 1691936557946849179);
  EXPECT_EQ(read.trajectory.poses[0].translation, Eigen::Vector3d(1, 2, 3));
}

TEST_F(ReadTrajectory, BoreasAnglesTurnAxes) {
  const TrajectoryFile read = read_trajectory(
      file("GPSTime,easting,northing,altitude,vel_east,vel_north,vel_up,roll,pitch,heading,"
           "angvel_z,angvel_y,angvel_x\n"
           "1606417097528152,5,6,7,0,0,0,0,0,1.5707963267948966,0,0,0\n"));
  EXPECT_EQ(read.format, "Boreas");
  EXPECT_EQ(read.trajectory.stamps_ns[0], 1606417097528152000);
  const Eigen::Matrix3d expected = (Eigen::Matrix3d() << 0, 1, 0, -1, 0, 0, 0, 0, 1).finished();
  EXPECT_LT((read.trajectory.poses[0].matrix().topLeftCorner<3, 3>() - expected).norm(), 1e-12);
}

TEST_F(ReadTrajectory, NcltIsTurnedAndBeginsWhereItIsKnown) {
  const TrajectoryFile read =
      read_trajectory(file("1357847237000000,nan,nan,nan,nan,nan,nan\n"
                           "1357847238000000,1,2,3,0,0,1.5707963267948966\n"));
  EXPECT_EQ(read.format, "NCLT");
  ASSERT_EQ(read.trajectory.size(), 1U);
  EXPECT_EQ(read.trajectory.stamps_ns[0], 1357847238000000000);
  EXPECT_EQ(read.trajectory.poses[0].translation, Eigen::Vector3d(1, -2, -3));
  // A turn to the right, seen with z up.
  EXPECT_LT(
      (read.trajectory.poses[0].rotation * Eigen::Vector3d::UnitX() + Eigen::Vector3d::UnitY())
          .norm(),
      1e-12);
}

TEST_F(ReadTrajectory, NewerCollegeSpiresAndSouthBayByHand) {
  const TrajectoryFile college =
      read_trajectory(file("#sec,nsec,x,y,z,qx,qy,qz,qw\n1583836591,5,1,2,3,0,0,0,1\n"));
  EXPECT_EQ(college.format, "Newer College");
  EXPECT_EQ(college.trajectory.stamps_ns[0], 1583836591000000005);
  const TrajectoryFile spires = read_trajectory(file(
      "# counter, sec, nsec, x, y, z, qx, qy, qz, qw\n0, 1583836591, 5, 1, 2, 3, 0, 0, 0, 1\n"));
  EXPECT_EQ(spires.format, "Oxford Spires");
  EXPECT_EQ(spires.trajectory.poses[0].translation, Eigen::Vector3d(1, 2, 3));
  const TrajectoryFile bay = read_trajectory(file("1 100.5 1 2 3 0 0 0.7071068 0.7071068\n"));
  EXPECT_EQ(bay.format, "Apollo-SouthBay");
  EXPECT_EQ(bay.trajectory.stamps_ns[0], 100'500'000'000);
  EXPECT_NEAR(bay.trajectory.poses[0].angle(), std::numbers::pi / 2, 1e-6);
}

TEST_F(ReadTrajectory, PositionsAreReadWithAndWithoutStamps) {
  const TrajectoryFile bare = read_trajectory(file("1 2 3\n4 5 6\n"));
  EXPECT_EQ(bare.format, "positions");
  EXPECT_TRUE(bare.trajectory.positions_only);
  EXPECT_FALSE(bare.trajectory.has_stamps());
  EXPECT_EQ(bare.trajectory.poses[1].translation, Eigen::Vector3d(4, 5, 6));
  const TrajectoryFile stamped = read_trajectory(file("1700000000.25 2 3 4\n"));
  EXPECT_TRUE(stamped.trajectory.positions_only);
  EXPECT_EQ(stamped.trajectory.stamps_ns[0], 1'700'000'000'250'000'000);
  EXPECT_FALSE(read_trajectory(file("1 0 0 0 0 0 0 1\n")).trajectory.positions_only);
}

// Frame k begins at k / 10 s, its middle is 0.05 s later; stamps of the user's own win.
TEST_F(ReadTrajectory, ParisLucosPositionsHoldForTheMiddlesOfItsFrames) {
  const std::string rows = "1 2 3\n4 5 6\n7 8 9\n";
  const TrajectoryFile read = read_trajectory(file(rows, "gt_traj_lidar.txt"));
  EXPECT_EQ(read.format, "Paris-Luco");
  EXPECT_TRUE(read.trajectory.positions_only);
  EXPECT_EQ(read.trajectory.stamps_ns,
            (std::vector<std::int64_t>{50'000'000, 150'000'000, 250'000'000}));
  const TrajectoryFile timed =
      read_trajectory(file(rows, "gt_traj_lidar.txt"), file("5\n6\n7\n", "times"));
  EXPECT_EQ(timed.trajectory.stamps_ns[2], 7'000'000'000);
}

TEST_F(ReadTrajectory, OnlyNuScenesHasScenes) {
  try {
    read_trajectory(file("1 2 3\n"), {}, "scene-0061");
    ADD_FAILURE();
  } catch (const Error& error) {
    EXPECT_EQ(error.fault(), Fault::usage);
    EXPECT_THAT(error.what(), HasSubstr("scene-0061"));
  }
}

// Rotations as the data sets' documents have them, rows of a matrix.
TEST(Mounts, OfHiltiAndNcltAreWhatTheirDocumentsSay) {
  // imu_from_lidar of the handheld: x and y swapped and turned round, z down.
  const Rigid3 handheld = mount_from("hilti-2022");
  const Eigen::Vector3d seen = handheld * Eigen::Vector3d(1, 2, 3);
  EXPECT_LT((seen - Eigen::Vector3d(-2 - 0.001, -1 - 0.00855, -3 + 0.055)).norm(), 1e-6);
  // The robot's document has lidar_from_imu.
  Eigen::Matrix<double, 3, 4> rows;
  rows << 0.99938, -0.00340, 0.03502, -0.13406, -0.00370, -0.99996, 0.00855, -0.01090, 0.03499,
      -0.00867, -0.99935, 0.00611;
  const Rigid3 lidar_from_imu = Rigid3::from_matrix(rows);
  EXPECT_THAT(lidar_from_imu * mount_from("hilti-2023-robot"), PoseNear(Rigid3{}, 1e-5, 1e-5));
  // Body and Velodyne have z down; the reader turns both: a point d in the raw frames is diag(1,
  // -1, -1) d in ours.
  const auto degrees = [](double angle, const Eigen::Vector3d& axis) {
    return Eigen::AngleAxisd(angle * std::numbers::pi / 180.0, axis);
  };
  const Eigen::Matrix3d raw =
      (degrees(-90.703, Eigen::Vector3d::UnitZ()) * degrees(0.166, Eigen::Vector3d::UnitY()) *
       degrees(0.807, Eigen::Vector3d::UnitX()))
          .toRotationMatrix();
  const Eigen::Vector3d d(3, -4, 5);
  const Eigen::Vector3d raw_in_body = raw * d + Eigen::Vector3d(0.002, -0.004, -0.957);
  const Eigen::Vector3d in_body = mount_from("nclt-hits") * Eigen::Vector3d(3, 4, -5);
  EXPECT_LT((in_body - Eigen::Vector3d(raw_in_body.x(), -raw_in_body.y(), -raw_in_body.z())).norm(),
            1e-6);
}

TEST(Mounts, AreNumbersOrTheNameOfADataSet) {
  const Rigid3 written = mount_from("1,2,3,0,0,1,0");
  EXPECT_EQ(written.translation, Eigen::Vector3d(1, 2, 3));
  EXPECT_NEAR(written.angle(), std::numbers::pi, 1e-12);
  // Turned by 135 degrees against the camera.
  const Rigid3 college = mount_from("newer-college-2020");
  EXPECT_NEAR(college.angle(), 0.75 * std::numbers::pi, 1e-2);
  EXPECT_NEAR(college.rotation.norm(), 1.0, 1e-15);
  EXPECT_NEAR(mount_from("oxford-spires").translation.z(), 0.124, 1e-15);
  for (const char* wrong : {"", "newer-college", "1,2,3", "1,2,3,0,0,0,0", "a,2,3,0,0,0,1"}) {
    try {
      mount_from(wrong);
      ADD_FAILURE() << wrong;
    } catch (const Error& error) {
      EXPECT_EQ(error.fault(), Fault::usage);
      EXPECT_THAT(error.what(), HasSubstr("newer-college-2020"));
    }
  }
}

TEST_F(ReadTrajectory, EurocByHand) {
  const TrajectoryFile read =
      read_trajectory(file("\xef\xbb\xbf#timestamp, p_x [m], ...\r\n"
                           "1403715524907143168,0.5,-1.5,2.5,0.8,0.6,0,0,-0.002,9,9\r\n\r\n"
                           "1403715524912143104, 1,2,3, 0,0,0,-1 ,1,1,1\r\n"));
  EXPECT_EQ(read.format, "EuRoC");
  EXPECT_EQ(read.trajectory.stamps_ns,
            (std::vector<std::int64_t>{1403715524907143168, 1403715524912143104}));
  EXPECT_THAT(read.trajectory.poses[0],
              PoseNear(Rigid3{Eigen::Quaterniond(0.8, 0.6, 0.0, 0.0), {0.5, -1.5, 2.5}}, 0, 1e-15));
  EXPECT_THAT(read.trajectory.poses[1],
              PoseNear(Rigid3{Eigen::Quaterniond(0.0, 0.0, 0.0, 1.0), {1, 2, 3}}, 0, 1e-15));
}

TEST_F(ReadTrajectory, FourDecimalsAreARotation) {
  const TrajectoryFile read = read_trajectory(file("1.5 0 0 0 0.5773 0.5773 0.5773 0.0001"));
  EXPECT_NEAR(read.trajectory.poses[0].rotation.norm(), 1.0, 1e-15);
}

TEST_F(ReadTrajectory, RepeatedStampsAreCounted) {
  const TrajectoryFile read =
      read_trajectory(file("1 1 0 0 0 0 0 1\n1 2 0 0 0 0 0 1\n1.000000001 3 0 0 0 0 0 1\n"));
  EXPECT_EQ(read.repeated, 1U);
  EXPECT_EQ(read.trajectory.size(), 3U);
}

TEST_F(ReadTrajectory, HostileFilesNameTheLine) {
  const std::string good = "1 0 0 0 0 0 0 1\n";
  const std::string kitti = "1 0 0 0 0 1 0 0 0 0 1 0\n";
  const std::vector<std::pair<std::string, std::string>> cases{
      {"", "holds no pose"},
      {"# only a comment\n\n", "holds no pose"},
      {"1 2\n", "line 1"},
      {"1 2 3\n1 2 3 4\n", "line 2: some lines have a stamp"},
      {"1 2 3\n1 2\n", "line 2: 2 columns"},
      {"1 2 3 4\n0.5 2 3 4\n", "line 2: the stamp is before"},
      {std::string("\0\1\2\xff\n", 5), "line 1"},
      {"#\n" + good + "2 0 0 0 0 0 1\n", "line 3: 7 columns"},
      {good + "2 0 0 0 0 0 0 1 9\n", "line 2: 9 columns"},
      {good + "2 nan 0 0 0 0 0 1\n", "line 2: 'nan'"},
      {good + "2 0 inf 0 0 0 0 1\n", "line 2: 'inf'"},
      {good + "2 0 0 0x 0 0 0 1\n", "line 2: '0x'"},
      {good + "2 1e300 0 0 0 0 0 1\n", "line 2: a position beyond"},
      {good + "2 1e999 0 0 0 0 0 1\n", "line 2: '1e999'"},
      {good + "nan 0 0 0 0 0 0 1\n", "line 2: 'nan' is no stamp"},
      {"140371552490714 0 0 0 0 0 0 1\n", "divided by 1e9"},
      {good + "2 0 0 0 0 0 0 0\n", "line 2: the quaternion has length 0.0"},
      {good + "2 0 0 0 0.6 0.6 0.6 0.6\n", "line 2: the quaternion has length 1.2"},
      {good + "0.9 0 0 0 0 0 0 1\n", "line 2: the stamp is before"},
      {kitti + "2 0 0 0 0 1 0 0 0 0 1 0\n", "line 2: columns 1-3"},
      {kitti + "-1 0 0 0 0 1 0 0 0 0 1 0\n", "line 2: columns 1-3"},
      {kitti + "1 0 0 0 0 1 0 0 0 0 1\n", "line 2: 11 columns"},
      {kitti + "1 0 0 nan 0 1 0 0 0 0 1 0\n", "line 2: 'nan'"},
      {"1,2,3\n", "line 1"},
      {"1.5,0,0,0,1,0,0,0\n", "line 1: '1.5' is no stamp in whole nanoseconds"},
      {"1,0,0,0,1,0,0,0\n2,0,0,0,1,0,0\n", "line 2: 7 columns"},
      {"1,0,0,0,1,0,0,0\n2,0,,0,1,0,0,0\n", "line 2: ''"},
  };
  for (const auto& [text, part] : cases) {
    EXPECT_THAT(error_of(text), AllOf(HasSubstr("file"), HasSubstr(part))) << text;
  }
}

TEST_F(ReadTrajectory, TimesHaveToFit) {
  const std::string kitti = "1 0 0 0 0 1 0 0 0 0 1 0\n1 0 0 0 0 1 0 0 0 0 1 0\n";
  EXPECT_THAT(error_of(kitti, "1\n"), HasSubstr("1 stamps for the 2 poses"));
  EXPECT_THAT(error_of(kitti, "1\n1\n"), HasSubstr("stamp 2 is not after"));
  EXPECT_THAT(error_of(kitti, "1\nx\n"), HasSubstr("line 2"));
}

TEST_F(ReadTrajectory, PathsThatAreNoFile) {
  for (const std::filesystem::path& path : {temp_.path(), temp_.path() / "absent"}) {
    EXPECT_THROW(read_trajectory(path), Error) << path;
  }
}

}  // namespace
}  // namespace kissmap
