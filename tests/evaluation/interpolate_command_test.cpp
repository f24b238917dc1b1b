// SPDX-License-Identifier: MIT
// `kissmap eval --interpolate` on trajectories whose poses hold for other instants than those of
// the reference.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "evaluation/files.hpp"
#include "support/program.hpp"
#include "support/temp_dir.hpp"

namespace kissmap {
namespace {

using Json = nlohmann::json;
using testing::HasSubstr;

constexpr std::int64_t tenth_ns = 100'000'000;
constexpr std::int64_t start_ns = 1'606'417'097'528'152'000;

/// In a circle of 20 m, at 10 m/s.
Rigid3 circle_at(std::int64_t since_start_ns) {
  const double yaw = 0.5 * 1e-9 * static_cast<double>(since_start_ns);
  return {Eigen::Quaterniond(Eigen::AngleAxisd(yaw, Eigen::Vector3d::UnitZ())),
          {20.0 * std::sin(yaw), 20.0 * (1.0 - std::cos(yaw)), 0.0}};
}

std::string circle(std::int64_t first_ns, std::int64_t step_ns, int poses) {
  std::string text;
  for (std::int64_t t = first_ns; poses-- > 0; t += step_ns) {
    text += tum_line(start_ns + t, circle_at(t));
  }
  return text;
}

class InterpolateCommand : public testing::Test {
 protected:
  std::string path(const std::string& name) const { return temp_.path() / name; }
  ProgramResult eval(const std::string& reference, std::vector<std::string> more) const {
    std::vector<std::string> arguments{KISSMAP_BINARY,
                                       "eval",
                                       path("estimate.tum"),
                                       "--reference",
                                       path(reference),
                                       "--align",
                                       "none",
                                       "--json",
                                       path("out.json")};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return run_program(arguments);
  }
  Json json() const { return Json::parse(file_text(path("out.json"))); }

 private:
  TempDir temp_;
};

// Boreas: poses of the ends of sweeps, truth of their middles.
TEST_F(InterpolateCommand, TruthHalfASweepAsideIsMet) {
  write_text(path("estimate.tum"), circle(tenth_ns / 2, tenth_ns, 100));
  write_text(path("truth.tum"), circle(0, tenth_ns, 100));
  const ProgramResult nearest = eval("truth.tum", {});
  EXPECT_EQ(nearest.exit_code, 3);
  EXPECT_THAT(nearest.err, HasSubstr("interpolate"));
  const ProgramResult between = eval("truth.tum", {"--interpolate"});
  ASSERT_EQ(between.exit_code, 0) << between.err;
  EXPECT_THAT(between.out, HasSubstr("99 pairs by stamp, reference interpolated, over"));
  const Json estimate = json()["estimates"][0];
  EXPECT_EQ(estimate["interpolated"], "reference");
  EXPECT_LT(estimate["ate"]["translation_m"]["max"], 1e-8);
  EXPECT_LT(estimate["ate"]["rotation_deg"]["max"], 1e-6);
  EXPECT_EQ(json()["options"]["max_gap_s"], 0.25);
}

// Hilti: a control point every ten seconds.
TEST_F(InterpolateCommand, AFewControlPointsAreMet) {
  write_text(path("estimate.tum"), circle(0, tenth_ns, 400));
  write_text(path("truth.tum"), circle(43'210'000, 100 * tenth_ns, 4));
  const ProgramResult result = eval("truth.tum", {"--interpolate"});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const Json estimate = json()["estimates"][0];
  EXPECT_EQ(estimate["pairs"], 4);
  EXPECT_EQ(estimate["interpolated"], "estimate");
  EXPECT_LT(estimate["ate"]["translation_m"]["max"], 1e-8);
  const ProgramResult gaps = eval("truth.tum", {"--interpolate", "--max-gap", "0.05"});
  EXPECT_EQ(gaps.exit_code, 3);
  EXPECT_THAT(gaps.err, HasSubstr("within 0.05 s: raise the maximum gap"));
}

// Paris-Luco: row k of the truth is of the middle of frame k, straight on at 10 m/s. The poses are
// of the ends of sweeps, and frame 7 was refused.
TEST_F(InterpolateCommand, ParisLucoWithoutOneScan) {
  std::string truth;
  std::string estimate;
  for (int k = 0; k < 20; ++k) {
    truth += std::to_string(k + 0.5) + " 2 3\n";
    if (k == 7) continue;
    const std::int64_t end_ns = (k + 1) * tenth_ns;
    estimate += tum_line(end_ns, Rigid3{Eigen::Quaterniond::Identity(), {k + 1.0, 2.0, 3.0}});
  }
  write_text(path("gt_traj_lidar.txt"), truth);
  write_text(path("estimate.tum"), estimate);
  const ProgramResult result = eval("gt_traj_lidar.txt", {"--interpolate"});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const Json found = json()["estimates"][0];
  EXPECT_EQ(found["pairs"], 18);  // the last has no truth behind it
  EXPECT_LT(found["ate"]["translation_m"]["max"], 1e-6);
  EXPECT_EQ(json()["reference"]["format"], "Paris-Luco");
}

TEST_F(InterpolateCommand, OptionsThatDoNotBelongTogetherAreRefused) {
  write_text(path("estimate.tum"), circle(0, tenth_ns, 4));
  write_text(path("truth.tum"), circle(0, tenth_ns, 4));
  EXPECT_EQ(eval("truth.tum", {"--interpolate", "--tolerance", "0.1"}).exit_code, 2);
  EXPECT_EQ(eval("truth.tum", {"--max-gap", "0.1"}).exit_code, 2);
  EXPECT_EQ(eval("truth.tum", {"--interpolate", "--max-gap", "-1"}).exit_code, 2);
  EXPECT_EQ(eval("truth.tum", {"--topic", "scene-0061"}).exit_code, 2);
}

}  // namespace
}  // namespace kissmap
