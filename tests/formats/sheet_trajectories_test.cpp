// SPDX-License-Identifier: MIT
// Ground truth as published with the data sets, written by generators/*.py; poses worked out by
// hand.
#include <gtest/gtest.h>

#include <cmath>

#include "formats/sheet_truth.hpp"
#include "kissmap/formats/trajectory_file.hpp"

namespace kissmap {
namespace {

using test::Generated;

constexpr double quarter = 90.0;
constexpr double degree = 3.14159265358979323846 / 180.0;

Eigen::Matrix3d yaw(double degrees) {
  return Eigen::AngleAxisd(degrees * degree, Eigen::Vector3d::UnitZ()).toRotationMatrix();
}

Eigen::Matrix3d rows(std::initializer_list<double> numbers) {
  Eigen::Matrix3d matrix;
  std::copy(numbers.begin(), numbers.end(), matrix.data());
  return matrix.transpose();
}

void expect_pose(const Rigid3& pose,
                 const Eigen::Vector3d& translation,
                 const Eigen::Matrix3d& rotation,
                 double tolerance = 1e-8) {
  EXPECT_LE((pose.translation - translation).norm(), tolerance) << pose.translation.transpose();
  EXPECT_LE((pose.rotation.toRotationMatrix() - rotation).norm(), tolerance)
      << pose.rotation.toRotationMatrix();
}

using Stamps = std::vector<std::int64_t>;

TEST(SheetTruth, KittiPosesAreOfTheCamera) {
  const Generated written("write_kitti.py");
  const auto sequence = written.path() / "sequences/00";
  const auto file = read_trajectory(written.path() / "poses/00.txt", sequence / "times.txt");
  ASSERT_EQ(file.trajectory.size(), 2U);
  EXPECT_EQ(file.trajectory.stamps_ns, (Stamps{0, 103'622'400}));
  const Rigid3 cam0_from_lidar = read_kitti_calibration(sequence / "calib.txt");
  const Rigid3 second = cam0_from_lidar.inverse() * file.trajectory.poses[1] * cam0_from_lidar;
  // 0.3 m behind the camera: 0.3 m to the right of where it stands once the car looks left.
  expect_pose(second, {5.3, -0.3, 0}, yaw(quarter));
}

TEST(SheetTruth, MulranIsTakenFromTheBaseToTheOuster) {
  const Generated written("write_mulran.py");
  const auto file = read_trajectory(written.path() / "KAIST99/global_pose.csv");
  EXPECT_EQ(file.trajectory.stamps_ns,
            (Stamps{1'561'000'444'390'857'630, 1'561'000'444'490'857'630}));
  const auto& poses = file.trajectory.poses;
  ASSERT_EQ(poses.size(), 2U);
  expect_pose(poses[0], {351001.9542, 4026000.479, 21.8047}, yaw(179.6654), 1e-5);
  expect_pose(poses[0].inverse() * poses[1], {-8.3066, -1.7737, 0}, yaw(quarter), 1e-4);
}

TEST(SheetTruth, HeliprIsOfEachSensor) {
  const Generated written("write_helipr.py");
  for (const char* sensor : {"Ouster", "Velodyne", "Avia", "Aeva"}) {
    SCOPED_TRACE(sensor);
    const auto file = read_trajectory(written.path() / "Town/LiDAR_GT" /
                                      ("global_" + std::string(sensor) + "_gt.txt"));
    EXPECT_EQ(file.trajectory.stamps_ns,
              (Stamps{1'691'936'557'946'849'179, 1'691'936'558'046'849'179}));
    ASSERT_EQ(file.trajectory.size(), 2U);
    expect_pose(file.trajectory.poses[1], {10.5, -1, 0.25}, yaw(quarter));
  }
}

TEST(SheetTruth, ApolloRowsHaveAnIndexFirst) {
  const Generated written("write_pcd_sets.py");
  const auto file = read_trajectory(written.path() /
                                    "apollo/TestData/ColumbiaPark/2018-10-11/poses/gt_poses.txt");
  ASSERT_EQ(file.trajectory.size(), 12U);
  EXPECT_EQ(file.trajectory.stamps_ns[11], 1'539'300'001'200'000'000);
  // sin and cos of half the angle are 0.6 and 0.8, those of the angle 0.96 and 0.28.
  expect_pose(file.trajectory.poses[11],
              {588012.5, 4140000.25, -3.5},
              rows({0.28, -0.96, 0, 0.96, 0.28, 0, 0, 0, 1}));
}

TEST(SheetTruth, NcltIsTurnedToZUp) {
  const Generated written("write_nclt.py");
  const auto file = read_trajectory(written.path() / "ground_truth/groundtruth_2012-01-08.csv");
  // The first row is not a number.
  EXPECT_EQ(file.trajectory.stamps_ns,
            (Stamps{1'326'030'975'726'043'000, 1'326'030'975'926'042'000}));
  ASSERT_EQ(file.trajectory.size(), 2U);
  expect_pose(file.trajectory.poses[0], {1, -2, -3}, Eigen::Matrix3d::Identity());
  // Rz(90) Rx(90) is rows (0 0 1) (1 0 0) (0 1 0); y and z change their signs before and after.
  expect_pose(file.trajectory.poses[1], {4, -2, -3}, rows({0, 0, -1, -1, 0, 0, 0, 1, 0}));
}

TEST(SheetTruth, NewerCollegeIsOfTheCamera) {
  const Generated written("write_pcd_sets.py");
  const auto file = read_trajectory(written.path() / "short/ground_truth/registered_poses.csv");
  EXPECT_EQ(file.repeated, 1U);
  EXPECT_EQ(
      file.trajectory.stamps_ns,
      (Stamps{1'583'836'591'000'000'005, 1'583'836'591'000'000'005, 1'583'836'591'182'590'976}));
  const Rigid3 mount = mount_from("newer-college-2020");
  const double turned = 2 * std::atan2(0.924, 0.383) / degree;  // 135 degrees, as printed
  expect_pose(file.trajectory.poses.at(0) * mount, {0.916, 1.975, 3.05}, yaw(turned));
  expect_pose(file.trajectory.poses.at(2) * mount, {4.025, 1.916, 3.05}, yaw(turned + quarter));
}

TEST(SheetTruth, BoreasAnglesArePassive) {
  const Generated written("write_boreas.py");
  const auto file =
      read_trajectory(written.path() / "boreas-2020-11-26-13-58/applanix/lidar_poses.csv");
  const auto& poses = file.trajectory.poses;
  ASSERT_EQ(poses.size(), 4U);
  EXPECT_EQ(file.trajectory.stamps_ns[1], 1'606'417'097'628'169'000);
  expect_pose(poses[0], {10.5, -20.25, 3}, Eigen::Matrix3d::Identity());
  expect_pose(poses[1], {11.5, -20.25, 3}, rows({0, 1, 0, -1, 0, 0, 0, 0, 1}));
  // C_roll C_yaw = rows (1 0 0) (0 0 1) (0 -1 0) times rows (0 1 0) (-1 0 0) (0 0 1)
  expect_pose(poses[2], {12.5, -20.25, 3}, rows({0, 1, 0, 0, 0, 1, 1, 0, 0}));
  expect_pose(poses[3], {13.5, -20.25, 3}, rows({0, 0, -1, 0, 1, 0, 1, 0, 0}));
}

TEST(SheetTruth, ParisLucoHasPositionsOnly) {
  const Generated written("write_paris_luco.py");
  const auto file = read_trajectory(written.path() / "00/gt_traj_lidar.txt");
  EXPECT_TRUE(file.trajectory.positions_only);
  ASSERT_EQ(file.trajectory.size(), 3U);
  EXPECT_EQ(file.trajectory.poses[2].translation, Eigen::Vector3d(3, -0.5, 0.125));
}

TEST(SheetTruth, NuscenesIsOfTheCarInItsTables) {
  const Generated written("write_nuscenes.py");
  const auto file = read_trajectory(written.path(), {}, "scene-0103");
  const auto& poses = file.trajectory.poses;
  ASSERT_EQ(poses.size(), 3U);
  EXPECT_EQ(
      file.trajectory.stamps_ns,
      (Stamps{1'532'403'927'647'951'000, 1'532'403'927'697'951'000, 1'532'403'927'747'951'000}));
  expect_pose(poses[0], {412.25, 1180.5, 1.8}, yaw(-quarter));
  // The car faces north and the LiDAR's x east; it is 1 m ahead of the axle.
  expect_pose(poses[1], {421.25, 1181.5, 1.8}, yaw(0));
}

}  // namespace
}  // namespace kissmap
