// SPDX-License-Identifier: MIT
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "formats/pictures/axes.hpp"
#include "kissmap/formats/evaluation_report.hpp"
#include "support/random_walk.hpp"

namespace kissmap {
namespace {

std::vector<std::string> texts(const std::vector<Tick>& all) {
  std::vector<std::string> result;
  for (const Tick& tick : all) result.push_back(tick.text);
  return result;
}

TEST(Axes, TicksAreRoundNumbers) {
  EXPECT_THAT(texts(ticks({0.0, 10.0}, 5)), testing::ElementsAre("0", "2", "4", "6", "8", "10"));
  EXPECT_THAT(texts(ticks({-0.07, 0.11}, 4)),
              testing::ElementsAre("-0.05", "0.00", "0.05", "0.10"));
  EXPECT_THAT(texts(ticks({1.0, 1.0}, 5)), testing::IsEmpty());
  EXPECT_LT(ticks({1e17, 1e17 + 64}, 7).size(), 200U);
}

TEST(Axes, EqualScalesKeepShapes) {
  const Axes axes = fit_axes({100, 50, 700, 350}, {0.0, 10.0}, {0.0, 80.0}, true);
  const Eigen::Vector2f origin = axes.pixel_from(0.0, 0.0);
  EXPECT_NEAR(
      axes.pixel_from(1.0, 0.0).x() - origin.x(), origin.y() - axes.pixel_from(0.0, 1.0).y(), 1e-3);
  EXPECT_GT(axes.pixel_from(0.0, 80.0).y(), 50.0F);
  EXPECT_LT(origin.y(), 350.0F);
}

EvaluationReport report_of(const std::vector<Rigid3>& way, int estimates) {
  EvaluationReport report;
  report.options.alignment = MapAlignment::first;
  report.reference_poses = way;
  report.reference.name = "truth";
  for (int i = 0; i < estimates; ++i) {
    PosePairs pairs;
    pairs.reference = way;
    pairs.estimate = winding_way(way.size(), 0.4, 1.0 + 2.0 * i);
    report.estimates.push_back(
        {{"estimate", "TUM", way.size(), 0, 1.0}, evaluate(std::move(pairs), report.options)});
  }
  return report;
}

std::size_t pixels_like(const Picture& picture, int red, int green, int blue) {
  std::size_t count = 0;
  for (std::size_t i = 0; i + 2 < picture.rgb.size(); i += 3) {
    const auto near = [&](std::size_t at, int value) {
      return std::abs(picture.rgb[at] - value) < 8;
    };
    count += near(i, red) && near(i + 1, green) && near(i + 2, blue) ? 1 : 0;
  }
  return count;
}

TEST(ErrorPlot, ShowsEachTrajectoryInAColourOfItsOwn) {
  const std::vector<Rigid3> way = winding_way(400, 0.4);
  const Picture one = draw_evaluation(report_of(way, 1));
  const Picture two = draw_evaluation(report_of(way, 2));
  EXPECT_GT(pixels_like(one, 0, 115, 179), 500U);
  EXPECT_EQ(pixels_like(one, 214, 94, 0), 0U);
  EXPECT_GT(pixels_like(two, 214, 94, 0), 500U);
}

TEST(ErrorPlot, OfASinglePoseIsAPicture) {
  const Picture picture = draw_evaluation(report_of(winding_way(1, 0.4), 1));
  EXPECT_EQ(picture.rgb.size(), 3U * 1600U * static_cast<std::size_t>(picture.height));
}

}  // namespace
}  // namespace kissmap
