// SPDX-License-Identifier: MIT
// `kissmap eval` beside the ground truth of public data sets, in the files formats/generators
// write. The estimates are where the LiDAR then is, worked out by hand, so that nothing is left of
// the error.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "evaluation/files.hpp"
#include "support/program.hpp"
#include "support/temp_dir.hpp"

namespace kissmap {
namespace {

using Json = nlohmann::json;

class PublishedTruth : public testing::Test {
 protected:
  void generate(const std::string& script) const {
    const ProgramResult result =
        run_program({KISSMAP_TEST_PYTHON,
                     "-B",
                     KISSMAP_TEST_SOURCES "/../formats/generators/" + script,
                     temp_.path().string()});
    ASSERT_EQ(result.exit_code, 0) << result.err;
  }
  std::string path(const std::string& name) const { return temp_.path() / name; }

  /// ATE of an estimate, in the world of the reference unless `more` aligns it, over as many pairs
  /// as there have to be.
  void expect_agreement(const std::string& estimate,
                        const std::string& reference,
                        std::size_t pairs,
                        double tolerance,
                        std::vector<std::string> more = {}) const {
    write_text(path("estimate.txt"), estimate);
    std::vector<std::string> command = {KISSMAP_BINARY,
                                        "eval",
                                        path("estimate.txt"),
                                        "--reference",
                                        path(reference),
                                        "--json",
                                        path("out.json")};
    if (std::ranges::find(more, "--align") == more.end()) {
      more.insert(more.end(), {"--align", "none"});
    }
    command.insert(command.end(), more.begin(), more.end());
    const ProgramResult result = run_program(command);
    ASSERT_EQ(result.exit_code, 0) << result.err;
    const Json json = Json::parse(file_text(path("out.json"))).at("estimates").at(0);
    EXPECT_EQ(json.at("pairs"), pairs) << json.dump(1);
    EXPECT_LE(json.at("ate").at("translation_m").at("max"), tolerance);
    EXPECT_LE(json.at("ate").at("rotation_deg").at("max"), 60 * tolerance);
  }

 private:
  TempDir temp_;
};

TEST_F(PublishedTruth, KittiOfTheCamera) {
  generate("write_kitti.py");
  expect_agreement("1 0 0 0 0 1 0 0 0 0 1 0\n0 -1 0 5.3 1 0 0 -0.3 0 0 1 0\n",
                   "poses/00.txt",
                   2,
                   1e-6,
                   {"--kitti-calib", path("sequences/00/calib.txt"), "--align", "first"});
}

TEST_F(PublishedTruth, MulranOfTheBase) {
  generate("write_mulran.py");
  // Half of 179.6654 and of 269.6654 degrees. The mount's own roll and pitch are below 0.0004
  // degrees.
  const std::string first =
      "1561000444.390857630 351001.9542 4026000.479 21.8047 "
      "0 0 0.9999957370 0.0029199317\n";
  // (1.7042, -0.021) turned to the left by 90 degrees is (0.021, 1.7042).
  const std::string second =
      "1561000444.490857630 351010.271 4026002.2042 21.8047 "
      "0 0 0.7091684703 -0.7050390633\n";
  expect_agreement(first + second, "KAIST99/global_pose.csv", 2, 1e-5);
}

TEST_F(PublishedTruth, HeliprByStamp) {
  generate("write_helipr.py");
  // The reference's second pose only.
  expect_agreement("1691936558.046849179 10.5 -1 0.25 0 0 0.70710678 0.70710678\n",
                   "Town/LiDAR_GT/global_Aeva_gt.txt",
                   1,
                   1e-6);
}

TEST_F(PublishedTruth, NewerCollegeOfTheCamera) {
  generate("write_pcd_sets.py");
  const double half = std::atan2(0.924, 0.383);
  const double turned = half + std::atan(1.0);
  char text[300];
  std::snprintf(text,
                sizeof text,
                "1583836591.000000005 0.916 1.975 3.05 0 0 %.9f %.9f\n"
                "1583836591.182590976 4.025 1.916 3.05 0 0 %.9f %.9f\n",
                std::sin(half),
                std::cos(half),
                std::sin(turned),
                std::cos(turned));
  expect_agreement(
      text, "short/ground_truth/registered_poses.csv", 2, 1e-6, {"--mount", "newer-college-2020"});
}

TEST_F(PublishedTruth, BoreasOfTheLidar) {
  generate("write_boreas.py");
  // Headings are clockwise: -90 degrees about z, then rows (0 1 0) (0 0 1) (1 0 0), a third of a
  // turn.
  expect_agreement(
      "1606417097.528152 10.5 -20.25 3 0 0 0 1\n"
      "1606417097.628169 11.5 -20.25 3 0 0 -0.70710678 0.70710678\n"
      "1606417097.728186 12.5 -20.25 3 -0.5 -0.5 -0.5 0.5\n",
      "boreas-2020-11-26-13-58/applanix/lidar_poses.csv",
      3,
      1e-6);
}

TEST_F(PublishedTruth, NcltTurnedToZUp) {
  generate("write_nclt.py");
  // Rows (0 0 -1) (-1 0 0) (0 1 0): their trace is 0, w is half.
  expect_agreement(
      "1326030975.726043 1 -2 -3 0 0 0 1\n"
      "1326030975.926042 4 -2 -3 0.5 -0.5 -0.5 0.5\n",
      "ground_truth/groundtruth_2012-01-08.csv",
      2,
      1e-6);
}

TEST_F(PublishedTruth, NuscenesOfOneScene) {
  generate("write_nuscenes.py");
  expect_agreement(
      "1532402927.647951 412.25 1180.5 1.8 0 0 -0.70710678 0.70710678\n"
      "1532402927.697951 421.25 1181.5 1.8 0 0 0 1\n",
      "v1.0-mini",
      2,
      1e-6,
      {"--topic", "scene-0061"});
}

TEST_F(PublishedTruth, ParisLucoByIndex) {
  generate("write_paris_luco.py");
  write_text(path("estimate.txt"),
             "1 0 0 0 0 1 0 0 0 0 1 0\n1 0 0 1.5 0 1 0 0.25 0 0 1 0\n"
             "1 0 0 3 0 1 0 -0.5 0 0 1 0.125\n");
  const ProgramResult result = run_program({KISSMAP_BINARY,
                                            "eval",
                                            path("estimate.txt"),
                                            "--reference",
                                            path("00/gt_traj_lidar.txt"),
                                            "--align",
                                            "none",
                                            "--json",
                                            path("out.json")});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const Json ate = Json::parse(file_text(path("out.json"))).at("estimates").at(0).at("ate");
  EXPECT_LE(ate.at("translation_m").at("max"), 1e-9);
  EXPECT_EQ(ate.at("translation_m").at("count"), 3);
  EXPECT_EQ(ate.at("rotation_deg").at("count"), 0);
}

}  // namespace
}  // namespace kissmap
