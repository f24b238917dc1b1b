// SPDX-License-Identifier: MIT
#include "formats/trajectories/pose_lines.hpp"

#include <gmock/gmock.h>

#include <cstdio>
#include <limits>

#include "session/example_session.hpp"
#include "support/temp_dir.hpp"

namespace kissmap {
namespace {

// What an independent reader makes of a trajectory file: one number a line, exact.
std::vector<double> read_with_numpy(const std::filesystem::path& file) {
  const std::string command =
      "/usr/bin/python3 -c \"import numpy, sys\n"
      "for value in numpy.loadtxt(sys.argv[1], ndmin=2).ravel(): print(float(value).hex())\" '" +
      file.string() + "'";
  std::vector<double> values;
  FILE* pipe = popen(command.c_str(), "r");
  if (pipe == nullptr) return values;
  double value = 0.0;
  while (std::fscanf(pipe, "%la", &value) == 1) values.push_back(value);
  if (pclose(pipe) != 0) values.clear();
  return values;
}

bool has_numpy() {
  return std::system("/usr/bin/python3 -c 'import numpy' 2>/dev/null") == 0;
}

class TrajectoryFiles : public testing::Test {
 protected:
  void SetUp() override {
    if (!has_numpy()) GTEST_SKIP() << "needs /usr/bin/python3 with numpy (package python3-numpy)";
    write_session(session_, example_surfels(), path_);
  }
  Session session_ = example_session();
  TempDir folder_;
  std::filesystem::path path_ = folder_.path() / "session";
};

TEST_F(TrajectoryFiles, TumReadsBackExactlyInNumpy) {
  const std::vector<double> values = read_with_numpy(path_ / "trajectory.tum");
  ASSERT_EQ(values.size(), 8 * session_.scans.size());
  for (std::size_t i = 0; i < session_.scans.size(); ++i) {
    const MappedScan& scan = session_.scans[i].mapped;
    const double* row = &values[8 * i];
    EXPECT_EQ(row[0], std::strtod(seconds_text(scan.pose_stamp_ns).c_str(), nullptr));
    EXPECT_GE(row[7], 0.0);
    const double sign = scan.map_from_lidar.rotation.w() < 0.0 ? -1.0 : 1.0;
    for (int k = 0; k < 3; ++k) EXPECT_EQ(row[1 + k], scan.map_from_lidar.translation[k]);
    for (int k = 0; k < 4; ++k) {
      EXPECT_EQ(row[4 + k], sign * scan.map_from_lidar.rotation.coeffs()[k]);
    }
  }
}

TEST_F(TrajectoryFiles, KittiReadsBackExactlyInNumpy) {
  const std::vector<double> values = read_with_numpy(path_ / "trajectory_kitti.txt");
  ASSERT_EQ(values.size(), 12 * session_.scans.size());
  for (std::size_t i = 0; i < session_.scans.size(); ++i) {
    const Eigen::Matrix4d expected = session_.scans[i].mapped.map_from_lidar.matrix();
    for (int k = 0; k < 12; ++k) {
      EXPECT_EQ(values[12 * i + static_cast<std::size_t>(k)], expected(k / 4, k % 4));
    }
  }
}

TEST(PoseLines, StampsAreExact) {
  EXPECT_EQ(seconds_text(0), "0.000000000");
  EXPECT_EQ(seconds_text(1), "0.000000001");
  EXPECT_EQ(seconds_text(-1), "-0.000000001");
  EXPECT_EQ(seconds_text(-1'500'000'000), "-1.500000000");
  EXPECT_EQ(seconds_text(1'630'577'758'569'489'956), "1630577758.569489956");
  EXPECT_EQ(seconds_text(std::numeric_limits<std::int64_t>::min()), "-9223372036.854775808");
  EXPECT_EQ(seconds_text(std::numeric_limits<std::int64_t>::max()), "9223372036.854775807");
}

TEST(PoseLines, KnownPose) {
  Rigid3 pose;
  pose.translation = {1.0, -2.5, 0.1};
  pose.rotation = Eigen::Quaterniond(-0.6, 0.0, 0.0, 0.8);
  EXPECT_EQ(tum_line(2'000'000'000, pose), "2.000000000 1 -2.5 0.1 -0 -0 -0.8 0.6\n");
  EXPECT_EQ(kitti_line(Rigid3{}), "1 0 0 0 0 1 0 0 0 0 1 0\n");
}

}  // namespace
}  // namespace kissmap
