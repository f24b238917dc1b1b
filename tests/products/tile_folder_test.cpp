// SPDX-License-Identifier: MIT
#include "formats/products/tile_folder.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <random>

#include "kissmap/error.hpp"
#include "products/cloud_table.hpp"
#include "support/file_size_limit.hpp"
#include "support/folder_content.hpp"
#include "support/temp_dir.hpp"

namespace kissmap {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

class Tiles : public testing::Test {
 protected:
  Tiles() {
    std::mt19937 random(3);
    std::uniform_real_distribution<double> x(-50.0, 70.0);
    std::uniform_real_distribution<double> y(-8.0, 25.0);
    for (int i = 0; i < 2000; ++i) points_.push_back(at(x(random), y(random)));
    // On borders, and just below one, where single precision rounds up to it.
    points_.push_back(at(20.0, 0.0));
    points_.push_back(at(std::nextafter(20.0, 0.0), -20.0));
  }
  static CloudPoint at(double x, double y) {
    CloudPoint point;
    point.point.position = {x, y, 1.5};
    return point;
  }
  std::uint64_t write(bool overwrite = false) const {
    require_tile_target(folder(), overwrite);
    return write_tile_folder(folder(),
                             {points_.size(), [this](std::uint64_t i) { return points_[i]; }},
                             20,
                             options_,
                             overwrite);
  }
  std::string refusal(bool overwrite) const {
    try {
      write(overwrite);
    } catch (const Error& error) {
      EXPECT_EQ(error.fault(), Fault::output);
      return error.what();
    }
    return "none";
  }
  fs::path folder() const { return temp_.path() / "tiles"; }

  std::vector<CloudPoint> points_;
  CloudWriterOptions options_;

 private:
  TempDir temp_;
};

/// As Autoware's map loader reads it: two resolutions, then names with two whole numbers.
struct Metadata {
  std::map<std::string, double> resolution;
  std::map<std::string, std::pair<int, int>> corner;
};
Metadata metadata_of(const fs::path& folder) {
  const ProgramResult result =
      run_program({KISSMAP_TEST_PYTHON,
                   "-c",
                   "import yaml, sys\n"
                   "for k, v in yaml.safe_load(open(sys.argv[1])).items():\n"
                   "    assert isinstance(v, float) or [type(n) for n in v] == [int, int], (k, v)\n"
                   "    print(k, *(v if isinstance(v, list) else [v]))\n",
                   (folder / "pointcloud_map_metadata.yaml").string()});
  EXPECT_EQ(result.exit_code, 0) << result.err;
  Metadata metadata;
  std::istringstream lines(result.out);
  for (std::string line; std::getline(lines, line);) {
    std::istringstream words(line);
    std::string name;
    words >> name;
    if (name.ends_with(".pcd")) {
      words >> metadata.corner[name].first >> metadata.corner[name].second;
    } else {
      words >> metadata.resolution[name];
    }
  }
  return metadata;
}

TEST_F(Tiles, HoldEveryPointOnceInTheSquareTheMetadataNames) {
  const std::uint64_t count = write();
  const Metadata metadata = metadata_of(folder());
  EXPECT_EQ(metadata.resolution.at("x_resolution"), 20.0);
  EXPECT_EQ(metadata.resolution.at("y_resolution"), 20.0);
  EXPECT_EQ(metadata.resolution.size(), 2U);
  EXPECT_EQ(metadata.corner.size(), count);
  EXPECT_EQ(count, 7U * 3U);
  EXPECT_EQ(content_of(folder()).size(), count + 1) << "tiles and metadata, nothing else";
  std::vector<std::pair<double, double>> found;
  for (const auto& [name, corner] : metadata.corner) {
    const CloudTable tile = read_cloud(folder() / name);
    EXPECT_FALSE(tile.rows.empty());
    EXPECT_EQ(corner.first % 20, 0);
    for (const std::vector<double>& row : tile.rows) {
      ASSERT_GE(row[0], corner.first);
      ASSERT_LT(row[0], corner.first + 20);
      ASSERT_GE(row[1], corner.second);
      ASSERT_LT(row[1], corner.second + 20);
      found.emplace_back(row[0], row[1]);
    }
  }
  std::vector<std::pair<double, double>> wanted;
  for (const CloudPoint& point : points_) {
    const Eigen::Vector3f p = point.point.position.cast<float>();
    wanted.emplace_back(p.x(), p.y());
  }
  std::ranges::sort(found);
  std::ranges::sort(wanted);
  EXPECT_EQ(found, wanted);
}

TEST_F(Tiles, CountFromTheOffset) {
  options_.offset = {450'000.0, 5'411'000.0, 0.0};
  for (CloudPoint& point : points_) point.point.position += options_.offset;
  write();
  EXPECT_TRUE(fs::exists(folder() / "tile_-20_0.pcd"));
  EXPECT_EQ(file_text(folder() / "offset.txt"),
            "# add to x y z of the points [m]\n450000 5411000 0\n");
}

TEST_F(Tiles, ReplaceOnlyTilesAndOnlyWhenAsked) {
  write();
  const auto first = content_of(folder());
  EXPECT_THAT(refusal(false), HasSubstr("--overwrite"));
  points_.resize(10);
  EXPECT_LT(write(true), first.size());
  EXPECT_LT(content_of(folder()).size(), first.size()) << "no tile of the old map is left";
  std::ofstream(folder() / "lanelet2_map.osm") << "precious";
  EXPECT_THAT(refusal(true), HasSubstr("lanelet2_map.osm"));
  EXPECT_EQ(file_text(folder() / "lanelet2_map.osm"), "precious");
  fs::remove_all(folder());
  std::ofstream(folder()) << "a file";
  EXPECT_THAT(refusal(true), HasSubstr("not a folder of tiles"));
  EXPECT_EQ(file_text(folder()), "a file");
}

TEST_F(Tiles, AFullDiskLeavesTheOldOnes) {
  points_.resize(100);
  write();
  const auto before = content_of(folder());
  for (int i = 0; i < 30'000; ++i) points_.push_back(at(1.0, 1.0));
  {
    const FileSizeLimit full(200'000);
    EXPECT_THAT(refusal(true), HasSubstr("tile_0_0.pcd"));
  }
  EXPECT_EQ(content_of(folder()), before);
  EXPECT_FALSE(fs::exists(folder().string() + ".partial"));
  write(true);
  EXPECT_NE(content_of(folder()), before);
}

}  // namespace
}  // namespace kissmap
