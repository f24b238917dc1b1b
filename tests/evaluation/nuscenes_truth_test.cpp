// SPDX-License-Identifier: MIT
// Ground truth of nuScenes, worked out by hand from tables as its schema describes them.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <nlohmann/json.hpp>
#include <numbers>

#include "evaluation/files.hpp"
#include "kissmap/error.hpp"
#include "kissmap/formats/trajectory_file.hpp"
#include "support/matchers.hpp"
#include "support/program.hpp"
#include "support/temp_dir.hpp"

namespace kissmap {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::HasSubstr;

constexpr const char* scenes = R"([{"token": "x", "name": "scene-0061", "first_sample_token": "a"},
  {"token": "y", "name": "scene-0103", "first_sample_token": "b"}])";
// The rows of scene-0103 in the wrong order, a camera and another scene between them.
constexpr const char* sample_data = R"([
  {"token": "d2", "sample_token": "b", "ego_pose_token": "e2", "calibrated_sensor_token": "c1",
   "timestamp": 1533151603597590, "is_key_frame": false, "next": "",
   "filename": "sweeps/LIDAR_TOP/2.pcd.bin"},
  {"token": "i1", "sample_token": "b", "ego_pose_token": "e9", "calibrated_sensor_token": "c2",
   "timestamp": 1533151603512404, "is_key_frame": true, "next": "",
   "filename": "samples/CAM_FRONT/1.jpg"},
  {"token": "d0", "sample_token": "a", "ego_pose_token": "e0", "calibrated_sensor_token": "c1",
   "timestamp": 1533151600000000, "is_key_frame": true, "next": "",
   "filename": "samples/LIDAR_TOP/0.pcd.bin"},
  {"token": "d1", "sample_token": "b", "ego_pose_token": "e1", "calibrated_sensor_token": "c1",
   "timestamp": 1533151603547590, "is_key_frame": true, "next": "d2",
   "filename": "samples/LIDAR_TOP/1.pcd.bin"}])";
// [0.7071, 0, 0, 0.7071] is a quarter turn to the left: w comes first.
constexpr const char* ego_poses = R"([
  {"token": "e0", "timestamp": 1, "rotation": [1, 0, 0, 0], "translation": [9, 9, 0]},
  {"token": "e2", "timestamp": 3, "rotation": [1.0, 0, 0, 0], "translation": [101.0, 202.0, 0.0]},
  {"token": "e9", "timestamp": 9, "rotation": [0, 1, 0, 0], "translation": [7, 7, 7]},
  {"token": "e1", "timestamp": 2, "rotation": [0.7071, 0, 0, 0.7071],
   "translation": [100, 200, 0]}])";
// x right and y forward: turned to the right by a quarter.
constexpr const char* calibrated_sensors = R"([
  {"token": "c2", "rotation": [0.5, -0.5, 0.5, -0.5], "translation": [1.7, 0, 1.5],
   "camera_intrinsic": [[1, 0, 0], [0, 1, 0], [0, 0, 1]]},
  {"token": "c1", "rotation": [0.7071, 0, 0, -0.7071], "translation": [0.5, 0, 1.8],
   "camera_intrinsic": []}])";

class NuScenesTruth : public testing::Test {
 protected:
  NuScenesTruth() { write_tables("v1.0-mini"); }
  void write_tables(const std::string& version) const {
    write(version + "/scene.json", scenes);
    write(version + "/sample_data.json", sample_data);
    write(version + "/ego_pose.json", ego_poses);
    write(version + "/calibrated_sensor.json", calibrated_sensors);
  }
  void write(const std::string& name, const std::string& text) const {
    fs::create_directories((root() / name).parent_path());
    write_text(root() / name, text);
  }
  fs::path root() const { return temp_.path() / "nuscenes"; }
  std::string error_of(const std::string& topic = "scene-0103") const {
    try {
      read_trajectory(root(), {}, topic);
    } catch (const Error& error) {
      return error.what();
    }
    return "no error";
  }
  TempDir temp_;
};

TEST_F(NuScenesTruth, IsTheEgoPoseTimesTheMountOfTheLidar) {
  const TrajectoryFile read = read_trajectory(root(), {}, "scene-0103");
  EXPECT_EQ(read.format, "nuScenes");
  ASSERT_EQ(read.trajectory.size(), 2U);
  EXPECT_EQ(read.trajectory.stamps_ns,
            (std::vector<std::int64_t>{1533151603547590000, 1533151603597590000}));
  // Turned to the left with the car, the mount's 0.5 m forward is along y; the turns cancel.
  EXPECT_THAT(read.trajectory.poses[0],
              PoseNear(Rigid3{{1, 0, 0, 0}, {100, 200.5, 1.8}}, 1e-9, 1e-9));
  const Rigid3 right{
      Eigen::Quaterniond(Eigen::AngleAxisd(-std::numbers::pi / 2, Eigen::Vector3d::UnitZ())),
      {101.5, 202.0, 1.8}};
  EXPECT_THAT(read.trajectory.poses[1], PoseNear(right, 1e-9, 1e-9));
}

TEST_F(NuScenesTruth, TheSceneIsChosenAndSoAreTheTables) {
  EXPECT_THAT(error_of(""), AllOf(HasSubstr("scene-0061"), HasSubstr("--topic")));
  EXPECT_THAT(error_of("scene-9"), AllOf(HasSubstr("no such scene"), HasSubstr("scene-0103")));
  EXPECT_EQ(read_trajectory(root(), {}, "scene-0061").trajectory.size(), 1U);
  write_tables("v1.0-trainval");
  EXPECT_THAT(error_of(), AllOf(HasSubstr("several versions"), HasSubstr("v1.0-trainval")));
  EXPECT_EQ(read_trajectory(root() / "v1.0-mini", {}, "scene-0103").trajectory.size(), 2U);
}

TEST_F(NuScenesTruth, BrokenTablesAreNamed) {
  const std::vector<std::pair<std::string, std::string>> cases{
      {"ego_pose.json", "[]"},
      {"ego_pose.json", "[{\"token\": "},
      {"ego_pose.json", R"([{"token": "e1", "rotation": [0, 0, 0, 0], "translation": [1, 2, 3]}])"},
      {"ego_pose.json", R"([{"token": "e1", "rotation": [1, 0, 0], "translation": [1, 2, 3]}])"},
      {"ego_pose.json",
       R"([{"token": "e1", "rotation": [1, 0, 0, 0], "translation": [1, 2, "3"]}])"},
      {"ego_pose.json",
       R"([{"token": "e1", "rotation": [1, 0, 0, 0], "translation": [1, 2, 1e10]}])"},
      {"ego_pose.json", R"([{"token": "e1", "translation": [1, 2, 3]}])"},
      {"calibrated_sensor.json", R"([{"token": 7}])"}};
  for (const auto& [table, text] : cases) {
    write_tables("v1.0-mini");
    write("v1.0-mini/" + table, text);
    EXPECT_THAT(error_of(), HasSubstr(table)) << text;
  }
}

TEST_F(NuScenesTruth, TheCommandTakesIt) {
  // Both poses 1 m higher: aligned by the first pose, nothing is left of it.
  write("estimate.tum",
        tum_line(1533151603547590000, Rigid3{{1, 0, 0, 0}, {100, 200.5, 2.8}}) +
            tum_line(1533151603597590000, Rigid3{{1, 0, 0, 0}, {101.5, 202.0, 2.8}}));
  const ProgramResult result = run_program({KISSMAP_BINARY,
                                            "eval",
                                            root() / "estimate.tum",
                                            "--reference",
                                            root(),
                                            "--topic",
                                            "scene-0103",
                                            "--align",
                                            "none",
                                            "--json",
                                            root() / "out.json"});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const auto json = nlohmann::json::parse(file_text(root() / "out.json"));
  EXPECT_NEAR(json["estimates"][0]["ate"]["translation_m"]["max"], 1.0, 1e-9);
  EXPECT_NEAR(json["estimates"][0]["ate"]["rotation_deg"]["max"], 90.0, 1e-6);
}

}  // namespace
}  // namespace kissmap
