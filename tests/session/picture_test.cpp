// SPDX-License-Identifier: MIT
#include <gmock/gmock.h>

#include <cstdio>

#include "kissmap/formats/pictures.hpp"
#include "kissmap/formats/session.hpp"
#include "session/example_session.hpp"
#include "support/temp_dir.hpp"

namespace kissmap {
namespace {

struct Rgb {
  int red;
  int green;
  int blue;
  friend bool operator==(const Rgb&, const Rgb&) = default;
};

Rgb pixel(const Picture& picture, int x, int y) {
  const auto at = 3 * static_cast<std::size_t>(y * picture.width + x);
  return {picture.rgb[at], picture.rgb[at + 1], picture.rgb[at + 2]};
}

// Mean place of the pixels that satisfy a condition; (-1, -1) if there is none.
template <typename Condition>
Eigen::Vector2d centre_of(const Picture& picture, const Condition& condition) {
  Eigen::Vector2d sum = Eigen::Vector2d::Zero();
  double count = 0.0;
  for (int y = 0; y < picture.height; ++y) {
    for (int x = 0; x < picture.width; ++x) {
      if (!condition(pixel(picture, x, y))) continue;
      sum += Eigen::Vector2d(x, y);
      count += 1.0;
    }
  }
  return count > 0.0 ? Eigen::Vector2d(sum / count) : Eigen::Vector2d(-1.0, -1.0);
}

bool is_start(const Rgb& c) {
  return c == Rgb{51, 230, 89};
}
bool is_end(const Rgb& c) {
  return c == Rgb{242, 41, 33};
}

LocalMap flat_map(double from, double to) {
  LocalMap map;
  for (double x = from; x <= to; x += 0.5) {
    for (double y = -5.0; y <= 5.0; y += 0.5) {
      map.surfels.means.push_back(Eigen::Vector3d(x, y, 0.0).cast<float>());
      map.surfels.normals.emplace_back(0.0F, 0.0F, 1.0F);
    }
  }
  return map;
}

SessionScan scan_at(std::uint64_t index, double x, double y) {
  SessionScan scan;
  scan.log_index = index;
  scan.mapped.local_map_from_lidar.translation = {x, y, 0.0};
  return scan;
}

class MapPicture : public testing::Test {
 protected:
  // A path from (0, 0) to the right and then up to (30, 10).
  Picture draw(const LocalMap& map, int max_pixels = 500) {
    SessionWriter writer(folder_.path() / "session", false);
    writer.add_scan(scan_at(0, 0, 0));
    writer.add_scan(scan_at(1, 30, 0));
    writer.add_scan(scan_at(2, 30, 10));
    writer.add_local_map(map);
    return draw_map_from_above(writer.partial_path(), max_pixels);
  }
  TempDir folder_;
};

TEST_F(MapPicture, FitsTheWantedSizeAndKeepsSquarePixels) {
  const Picture picture = draw(flat_map(-5.0, 35.0));
  EXPECT_EQ(picture.width, 500);
  EXPECT_LT(picture.height, 300);
  EXPECT_EQ(picture.rgb.size(), 3U * 500U * static_cast<std::size_t>(picture.height));
}

TEST_F(MapPicture, HasXToTheRightAndYUp) {
  const Picture picture = draw(flat_map(-5.0, 35.0));
  const Eigen::Vector2d start = centre_of(picture, is_start);
  const Eigen::Vector2d end = centre_of(picture, is_end);
  ASSERT_GE(start.x(), 0.0);
  ASSERT_GE(end.x(), 0.0);
  // 30 m to the right are 3 times 10 m up, so scale and axes are right together.
  EXPECT_GT(end.x(), start.x());
  EXPECT_LT(end.y(), start.y());
  EXPECT_NEAR((end.x() - start.x()) / (start.y() - end.y()), 3.0, 0.1);
}

TEST_F(MapPicture, ScaleBarIsAsLongAsItSays) {
  const Picture picture = draw(flat_map(-5.0, 35.0));
  const double pixels_for_30_m = centre_of(picture, is_end).x() - centre_of(picture, is_start).x();
  const Rgb ink{242, 242, 247};
  int longest = 0;
  for (int y = picture.height - 30; y < picture.height; ++y) {
    int run = 0;
    for (int x = 0; x < picture.width / 2; ++x) {
      run = pixel(picture, x, y) == ink ? run + 1 : 0;
      longest = std::max(longest, run);
    }
  }
  EXPECT_NEAR(longest * 30.0 / pixels_for_30_m, 5.0, 0.2);  // metres
}

TEST_F(MapPicture, AFewFarReturnsDoNotShrinkTheMap) {
  LocalMap map = flat_map(-5.0, 35.0);
  const Picture expected = draw(map);
  map.surfels.means.emplace_back(110.0F, 0.0F, 0.0F);
  map.surfels.means.emplace_back(9000.0F, 9000.0F, 0.0F);
  map.surfels.normals.resize(map.surfels.means.size(), {0.0F, 0.0F, 1.0F});
  const Picture picture = draw(map);
  EXPECT_EQ(picture.width, expected.width);
  EXPECT_NEAR(picture.height, expected.height, 3);
}

TEST_F(MapPicture, ShowsTheMap) {
  const Picture empty = draw(LocalMap{});
  const Picture full = draw(flat_map(-5.0, 35.0));
  const auto bright = [](const Picture& picture) {
    std::size_t pixels = 0;
    for (std::size_t i = 0; i < picture.rgb.size(); i += 3) pixels += picture.rgb[i + 1] > 60;
    return static_cast<double>(pixels) / static_cast<double>(picture.rgb.size() / 3);
  };
  EXPECT_LT(bright(empty), 0.1);
  EXPECT_GT(bright(full), 0.4);
}

TEST_F(MapPicture, SessionWithoutScansGivesAPicture) {
  const SessionWriter writer(folder_.path() / "session", false);
  const Picture picture = draw_map_from_above(writer.partial_path(), 100);
  EXPECT_GT(picture.width, 0);
  EXPECT_LE(picture.width, 100);
}

TEST_F(MapPicture, SilentlyHugeOrTinyPicturesAreRefused) {
  const SessionWriter writer(folder_.path() / "session", false);
  for (const int pixels : {-1, 0, 63, 1 << 20}) {
    EXPECT_THAT(error_of([&] { draw_map_from_above(writer.partial_path(), pixels); }),
                testing::StartsWith("usage: "));
  }
}

TEST_F(MapPicture, IsReadByAnotherProgram) {
  if (std::system("command -v pngtopnm > /dev/null") != 0) {
    GTEST_SKIP() << "needs pngtopnm (package netpbm)";
  }
  const Picture picture = draw(flat_map(-5.0, 35.0));
  const auto png = folder_.path() / "map.png";
  const auto pnm = folder_.path() / "map.pnm";
  write_png(picture, png);
  const std::string command = "pngtopnm '" + png.string() + "' > '" + pnm.string() + "'";
  ASSERT_EQ(std::system(command.c_str()), 0);
  const std::string header =
      "P6\n" + std::to_string(picture.width) + " " + std::to_string(picture.height) + "\n255\n";
  const std::string pixels(picture.rgb.begin(), picture.rgb.end());
  EXPECT_EQ(read_file(pnm), header + pixels);
}

TEST(Png, PicturesOfTheWrongSizeAreDefectsOfTheCaller) {
  const TempDir folder;
  EXPECT_THAT(error_of([&] {
                write_png({2, 2, {1, 2, 3}}, folder.path() / "x.png");
              }),
              testing::StartsWith("internal: "));
  EXPECT_THAT(error_of([&] { write_png({}, folder.path() / "x.png"); }),
              testing::StartsWith("internal: "));
}

}  // namespace
}  // namespace kissmap
