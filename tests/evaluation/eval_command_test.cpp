// SPDX-License-Identifier: MIT
// The real binary, and beside it a script that knows the KITTI metric from its definition.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <sstream>

#include "evaluation/files.hpp"
#include "support/program.hpp"
#include "support/random_walk.hpp"
#include "support/small_log.hpp"
#include "support/temp_dir.hpp"

namespace kissmap {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using Json = nlohmann::json;

class EvalCommandLine : public testing::Test {
 protected:
  EvalCommandLine() {
    write_text(path("truth.tum"), tum_text(winding_way(900, 0.4)));
    write_text(path("near.tum"), tum_text(winding_way(900, 0.4, 1.0)));
    write_text(path("far.tum"), tum_text(winding_way(900, 0.4, 4.0)));
  }
  std::string path(const std::string& name) const { return temp_.path() / name; }
  ProgramResult eval(std::vector<std::string> arguments) const {
    arguments.insert(arguments.begin(), {KISSMAP_BINARY, "eval"});
    return run_program(arguments);
  }
  Json json_of(std::vector<std::string> arguments) const {
    arguments.insert(arguments.end(), {"--json", path("out.json")});
    const ProgramResult result = eval(arguments);
    EXPECT_EQ(result.exit_code, 0) << result.err;
    return Json::parse(file_text(path("out.json")));
  }

 private:
  TempDir temp_;
};

TEST_F(EvalCommandLine, SeveralTrajectoriesSideBySideInEveryForm) {
  const ProgramResult result = eval({path("near.tum"),
                                     path("far.tum"),
                                     "--reference",
                                     path("truth.tum"),
                                     "--json",
                                     path("r.json"),
                                     "--csv",
                                     path("r.csv"),
                                     "--plot",
                                     path("r.png")});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_THAT(result.out,
              AllOf(HasSubstr("near.tum (TUM, 900 poses"),
                    HasSubstr("900 pairs by stamp"),
                    HasSubstr("RPE over 10 m"),
                    HasSubstr("KITTI 100..800 m")));
  const Json json = Json::parse(file_text(path("r.json")));
  ASSERT_EQ(json["estimates"].size(), 2U);
  const double near = json["estimates"][0]["ate"]["translation_m"]["rmse"];
  const double far = json["estimates"][1]["ate"]["translation_m"]["rmse"];
  EXPECT_GT(near, 0.0);
  EXPECT_GT(far, 3.0 * near);
  char shown[64];
  std::snprintf(shown, sizeof shown, "%.6f %13.6f\n", near, far);
  EXPECT_THAT(result.out, HasSubstr(shown));
  std::string row = path("far.tum") + ",ate,,translation,m,900,";
  EXPECT_THAT(file_text(path("r.csv")), HasSubstr(row + Json(far).dump() + ","));
  EXPECT_EQ(file_text(path("r.png")).substr(1, 3), "PNG");
}

TEST_F(EvalCommandLine, TheTruthHasNoError) {
  const Json json = json_of({path("truth.tum"), "--reference", path("truth.tum")});
  const Json& estimate = json["estimates"][0];
  EXPECT_LT(estimate["ate"]["translation_m"]["max"], 1e-9);
  EXPECT_LT(estimate["kitti"]["translation_percent"], 1e-9);
  EXPECT_GT(estimate["kitti"]["segments"], 50);
}

// The reference is of a camera beside the LiDAR: without the mount each turn moves them apart.
TEST_F(EvalCommandLine, AReferenceOfAnotherSensorWantsTheMount) {
  const Rigid3 camera_from_lidar{
      Eigen::Quaterniond(Eigen::AngleAxisd(0.7, Eigen::Vector3d::UnitX())), {0.5, -2.0, 0.25}};
  std::vector<Rigid3> of_camera = winding_way(900, 0.4);
  for (Rigid3& pose : of_camera) pose = pose * camera_from_lidar.inverse();
  write_text(path("camera.tum"), tum_text(of_camera));
  std::string mount = tum_line(0, camera_from_lidar);
  mount = mount.substr(mount.find(' ') + 1);
  mount.pop_back();
  std::ranges::replace(mount, ' ', ',');
  const auto error = [&](const std::vector<std::string>& more) {
    std::vector<std::string> arguments{path("truth.tum"), "--reference", path("camera.tum")};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return json_of(arguments)["estimates"][0];
  };
  EXPECT_GT(error({})["ate"]["translation_m"]["rmse"], 0.5);
  const Json with_mount = error({"--mount", mount});
  EXPECT_LT(with_mount["ate"]["translation_m"]["max"], 1e-9);
  EXPECT_LT(with_mount["ate"]["rotation_deg"]["max"], 1e-6);
  EXPECT_EQ(eval({path("truth.tum"), "--reference", path("camera.tum"), "--mount", "x"}).exit_code,
            2);
}

// Of the same figures as the whole poses, only those of positions are there.
TEST_F(EvalCommandLine, OfAReferenceOfPositionsTheAteOfPositionsIsTold) {
  std::string positions;
  for (const Rigid3& pose : winding_way(900, 0.4)) {
    std::ostringstream line;
    line.precision(17);
    line << pose.translation.transpose() << '\n';
    positions += line.str();
  }
  write_text(path("positions.txt"), positions);
  const Json whole = json_of({path("near.tum"), "--reference", path("truth.tum")})["estimates"][0];
  const Json found =
      json_of({path("near.tum"), "--reference", path("positions.txt")})["estimates"][0];
  const double expected = whole["ate"]["translation_m"]["rmse"];
  EXPECT_NEAR(found["ate"]["translation_m"]["rmse"], expected, 1e-9);
  EXPECT_TRUE(found["ate"]["rotation_deg"]["rmse"].is_null()) << found["ate"].dump();
  const ProgramResult shown = eval({path("near.tum"), "--reference", path("positions.txt")});
  EXPECT_EQ(shown.exit_code, 0) << shown.err;
  EXPECT_THAT(shown.out, HasSubstr("(positions, 900 poses"));
  const ProgramResult first =
      eval({path("near.tum"), "--reference", path("positions.txt"), "--align", "first"});
  EXPECT_EQ(first.exit_code, 3);
  EXPECT_THAT(first.err, HasSubstr("align by se3"));
}

TEST_F(EvalCommandLine, TheKittiErrorEqualsTheIndependentScript) {
  for (const std::string lengths : {"100,200,300,400,500,600,700,800", "1,2,5,10", "0.5,350"}) {
    write_text(path("r.txt"), kitti_text(winding_way(900, 0.4)));
    write_text(path("e.txt"), kitti_text(winding_way(900, 0.4, 2.0)));
    const Json json = json_of({path("e.txt"), "--reference", path("r.txt"), "--segments", lengths});
    const Json& kitti = json["estimates"][0]["kitti"];
    std::vector<std::string> script{
        KISSMAP_TEST_PYTHON, KISSMAP_TEST_SOURCES "/kitti_metric.py", path("r.txt"), path("e.txt")};
    std::istringstream words(lengths);
    for (std::string word; std::getline(words, word, ',');) script.push_back(word);
    const ProgramResult expected = run_program(script);
    ASSERT_EQ(expected.exit_code, 0) << expected.err;
    std::istringstream lines(expected.out);
    double length = 0.0;
    double translation = 0.0;
    double rotation = 0.0;
    std::size_t segments = 0;
    std::size_t row = 0;
    while (lines >> length >> segments >> translation >> rotation) {
      const Json& mine = length > 0.0 ? kitti["lengths"][row++] : kitti;
      EXPECT_EQ(mine["segments"], segments) << length;
      if (segments == 0) {
        EXPECT_TRUE(mine["translation_percent"].is_null());
        continue;
      }
      EXPECT_NEAR(mine["translation_percent"], translation, 1e-9) << length;
      EXPECT_NEAR(mine["rotation_deg_per_m"], rotation, 1e-7) << length;
    }
    EXPECT_EQ(row, kitti["lengths"].size());
    EXPECT_GT(segments, 50U);
  }
}

TEST_F(EvalCommandLine, OffsetAndIndexJoinWhatStampsDoNot) {
  std::string late = tum_text(winding_way(900, 0.4, 1.0));
  for (std::size_t at = late.find("\n17"); at != late.npos; at = late.find("\n17", at + 1)) {
    late[at + 2] = '6';  // a hundred million seconds earlier
  }
  write_text(path("late.tum"), late);
  const ProgramResult apart = eval({path("late.tum"), "--reference", path("truth.tum")});
  EXPECT_EQ(apart.exit_code, 3);
  EXPECT_THAT(apart.err,
              AllOf(HasSubstr("late.tum"),
                    HasSubstr("1600000000.000 to 1600000089.900"),
                    HasSubstr("1700000000.000 to 1700000089.900"),
                    HasSubstr("offset of 100000000.000 s")));
  const Json joined =
      json_of({path("late.tum"), "--reference", path("truth.tum"), "--offset", "100000000"});
  const Json direct = json_of({path("near.tum"), "--reference", path("truth.tum")});
  EXPECT_EQ(joined["estimates"][0]["ate"], direct["estimates"][0]["ate"]);
  write_text(path("plain.txt"), kitti_text(winding_way(900, 0.4, 1.0)));
  const Json plain = json_of({path("plain.txt"), "--reference", path("truth.tum")});
  EXPECT_EQ(plain["estimates"][0]["paired_by"], "index");
  EXPECT_NEAR(plain["estimates"][0]["ate"]["translation_m"]["rmse"],
              direct["estimates"][0]["ate"]["translation_m"]["rmse"],
              1e-9);
}

TEST_F(EvalCommandLine, ACalibrationMovesTheEstimateToTheCamera) {
  const Rigid3 cam0_from_lidar{Eigen::Quaterniond(0.5, 0.5, -0.5, 0.5), {0.1, -0.2, -0.3}};
  std::string line = "P0: 1 2 3\nTr: " + kitti_line(cam0_from_lidar);
  write_text(path("calib.txt"), line);
  std::vector<Rigid3> lidar = winding_way(900, 0.4);
  for (Rigid3& pose : lidar) pose = pose * cam0_from_lidar;
  write_text(path("lidar.txt"), kitti_text(lidar));
  const std::vector<std::string> arguments{
      path("lidar.txt"), "--reference", path("truth.tum"), "--align", "none"};
  EXPECT_GT(json_of(arguments)["estimates"][0]["ate"]["translation_m"]["rmse"], 0.3);
  std::vector<std::string> with = arguments;
  with.insert(with.end(), {"--kitti-calib", path("calib.txt")});
  EXPECT_LT(json_of(with)["estimates"][0]["ate"]["translation_m"]["max"], 1e-9);
}

TEST_F(EvalCommandLine, ASessionIsItsTrajectory) {
  write_small_log(path("log"), 12);
  const ProgramResult made = run_program(
      {KISSMAP_BINARY, "run", "--no-products", path("log"), "-o", path("session"), "--quiet"});
  ASSERT_EQ(made.exit_code, 0) << made.err;
  const Json json = json_of({path("session"),
                             "--reference",
                             path("session/trajectory.tum"),
                             "--align",
                             "none",
                             "--tolerance",
                             "0"});
  EXPECT_EQ(json["estimates"][0]["format"], "session");
  EXPECT_EQ(json["estimates"][0]["pairs"], 12);
  EXPECT_LT(json["estimates"][0]["ate"]["translation_m"]["max"], 1e-12);
}

TEST_F(EvalCommandLine, UsageErrorsExitWith2AndInputErrorsWith3) {
  const std::string truth = path("truth.tum");
  const std::vector<std::pair<std::vector<std::string>, std::string>> wrong{
      {{"--align", "sim3"}, "sim3"},
      {{"--delta", "5"}, "--delta"},
      {{"--delta", "xm"}, "--delta"},
      {{"--delta", "1.5f"}, "1.5"},
      {{"--delta", "-1m"}, "delta"},
      {{"--delta", "nanm"}, "delta"},
      {{"--tolerance", "-1"}, "tolerance"},
      {{"--segments", "0"}, "segments"},
      {{"--json", truth}, "named twice"},
      {{"--json", path("x"), "--csv", path("x")}, "named twice"},
      {{"--plto", "x.png"}, "--plto"},
  };
  for (const auto& [more, part] : wrong) {
    std::vector<std::string> arguments{path("near.tum"), "--reference", truth};
    arguments.insert(arguments.end(), more.begin(), more.end());
    const ProgramResult result = eval(arguments);
    EXPECT_EQ(result.exit_code, 2) << more[0] << " " << more[1];
    EXPECT_THAT(result.err, HasSubstr(part));
  }
  EXPECT_EQ(eval({path("near.tum")}).exit_code, 2);
  EXPECT_EQ(eval({path("absent"), "--reference", truth}).exit_code, 3);
  EXPECT_EQ(eval({path("near.tum"), "--reference", path("absent")}).exit_code, 3);
  EXPECT_EQ(eval({path("near.tum"), "--reference", truth, "--csv", "/absent/x"}).exit_code, 4);
}

TEST_F(EvalCommandLine, APoseAloneOrALineSaysWhatToDo) {
  write_text(path("one.tum"), tum_text(winding_way(1, 0.4)));
  const ProgramResult result = eval({path("one.tum"), "--reference", path("truth.tum")});
  EXPECT_EQ(result.exit_code, 3);
  EXPECT_THAT(result.err, HasSubstr("first pose"));
  const std::vector<std::string> first{path("one.tum"),
                                       "--reference",
                                       path("truth.tum"),
                                       "--align",
                                       "first",
                                       "--plot",
                                       path("one.png")};
  EXPECT_TRUE(json_of(first)["estimates"][0]["kitti"]["translation_percent"].is_null());
}

}  // namespace
}  // namespace kissmap
