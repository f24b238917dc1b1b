// SPDX-License-Identifier: MIT
#include "support/map_loader_rules.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <string>

#include "kissmap/error.hpp"
#include "support/plan_files.hpp"
#include "support/temp_dir.hpp"

namespace kissmap {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

const MapLoader both[] = {MapLoader::map_server, MapLoader::nav2};

class MapRules : public testing::Test {
 protected:
  // A row of pixels and a YAML of these lines beside the usual ones; a line of the same key wins.
  std::filesystem::path map(const std::string& pixels, const std::string& lines = {}) const {
    std::ofstream(folder_.path() / "map.pgm", std::ios::binary) << "P5\n# a comment 7 7\n"
                                                                << pixels.size() << " 1\n255\n"
                                                                << pixels;
    std::string yaml = lines;
    for (const std::string line : {"image: map.pgm",
                                   "resolution: 0.05",
                                   "origin: [-1.5, 2, 0]",
                                   "negate: 0",
                                   "occupied_thresh: 0.65",
                                   "free_thresh: 0.196"}) {
      const std::string key = line.substr(0, line.find(':') + 1);
      if (lines.find(key) == std::string::npos) yaml += line + "\n";
    }
    return written(yaml);
  }

  std::filesystem::path written(const std::string& yaml) const {
    const std::filesystem::path path = folder_.path() / "map.yaml";
    std::ofstream(path) << yaml;
    return path;
  }

  void expect_refused(const std::filesystem::path& yaml, MapLoader loader, const char* why) const {
    try {
      load_map(yaml, loader);
      ADD_FAILURE() << "accepted: " << why;
    } catch (const Error& error) {
      EXPECT_EQ(error.fault(), Fault::input);
      EXPECT_THAT(error.what(), HasSubstr(why));
    }
  }

  TempDir folder_;
};

TEST_F(MapRules, TheUsualGreysMeanTheSameToBoth) {
  for (const MapLoader loader : both) {
    const LoadedMap map = load_map(this->map("\xFE" + std::string(1, '\0') + "\xCD\xFF"), loader);
    EXPECT_THAT(map.data, ElementsAre(0, 100, -1, 0));
    EXPECT_EQ(map.width, 4);
    EXPECT_EQ(map.height, 1);
    EXPECT_EQ(map.resolution, 0.05);
    EXPECT_THAT(map.origin, ElementsAre(-1.5, 2.0, 0.0));
  }
}

// occ(205) = 50 / 255 = 0.19608.
TEST_F(MapRules, UnknownTurnsFreeWithALooserThreshold) {
  for (const MapLoader loader : both) {
    EXPECT_THAT(load_map(map("\xCD", "free_thresh: 0.25\n"), loader).data, ElementsAre(0));
    EXPECT_THAT(load_map(map("\xCD", "free_thresh: 0.1961\n"), loader).data, ElementsAre(0));
    EXPECT_THAT(load_map(map("\xCD", "free_thresh: 0.196\n"), loader).data, ElementsAre(-1));
  }
}

// Black is exactly 1, white exactly 0: there the rules part.
TEST_F(MapRules, OnTheThresholdOnlyNav2Decides) {
  const std::string black_and_white = std::string(1, '\0') + "\xFF";
  const std::string lines = "occupied_thresh: 1.0\nfree_thresh: 0.0\n";
  EXPECT_THAT(load_map(map(black_and_white, lines), MapLoader::map_server).data,
              ElementsAre(-1, -1));
  EXPECT_THAT(load_map(map(black_and_white, lines), MapLoader::nav2).data, ElementsAre(100, 0));
}

// occ(158) = 97 / 255, ratio 0.4510: 45.20 cut to 45, and 45.10 rounded to 45. occ(127) = 128 /
// 255, ratio 0.7549: 74.98 cut to 74, and 75.49 rounded to 75.
TEST_F(MapRules, ScaleGradesWhatLiesBetween) {
  const std::string pixels = "\x9E\x7F" + std::string(1, '\0') + "\xFF";
  const std::string lines = "mode: scale\noccupied_thresh: 0.6\nfree_thresh: 0.2\n";
  EXPECT_THAT(load_map(map(pixels, lines), MapLoader::map_server).data,
              ElementsAre(45, 74, 100, 0));
  EXPECT_THAT(load_map(map(pixels, lines), MapLoader::nav2).data, ElementsAre(45, 75, 100, 0));
}

TEST_F(MapRules, NegateSwapsBlackAndWhite) {
  const std::string pixels = std::string(1, '\0') + "\xFF";
  for (const MapLoader loader : both) {
    EXPECT_THAT(load_map(map(pixels, "negate: 1\n"), loader).data, ElementsAre(0, 100));
  }
  EXPECT_THAT(load_map(map(pixels, "negate: true\n"), MapLoader::nav2).data, ElementsAre(0, 100));
  EXPECT_THAT(load_map(map(pixels, "negate: false\n"), MapLoader::nav2).data, ElementsAre(100, 0));
  expect_refused(map(pixels, "negate: true\n"), MapLoader::map_server, "negate");
}

TEST_F(MapRules, EveryMandatoryKeyIsMissed) {
  const std::string keys[] = {"image: map.pgm\n",
                              "resolution: 0.05\n",
                              "origin: [0, 0, 0]\n",
                              "negate: 0\n",
                              "occupied_thresh: 0.65\n",
                              "free_thresh: 0.196\n"};
  map("\xFE");
  for (const std::string& without : keys) {
    std::string yaml;
    for (const std::string& line : keys) {
      if (line != without) yaml += line;
    }
    const std::string key = without.substr(0, without.find(':'));
    for (const MapLoader loader : both) {
      expect_refused(written(yaml), loader, (key + " is missing").c_str());
    }
  }
}

TEST_F(MapRules, RefusesBadValuesAndImages) {
  for (const MapLoader loader : both) {
    expect_refused(map("\xFE", "origin: [0, 0]\n"), loader, "three numbers");
    expect_refused(map("\xFE", "origin: [0, 0, 0, 0]\n"), loader, "three numbers");
    expect_refused(map("\xFE", "origin: [0, north, 0]\n"), loader, "origin");
    expect_refused(map("\xFE", "resolution: fine\n"), loader, "resolution");
    expect_refused(map("\xFE", "resolution: 0\n"), loader, "positive");
    expect_refused(map("\xFE", "mode: colour\n"), loader, "mode colour");
    expect_refused(map("\xFE", "mode: raw\n"), loader, "mode raw");
    expect_refused(map("\xFE", "image: \"\"\n"), loader, "empty");
    expect_refused(map("\xFE", "image: other.pgm\n"), loader, "other.pgm");
    expect_refused(written("just words\n"), loader, "no keys");
    expect_refused(written("image: [\n"), loader, "map.yaml");
    expect_refused(folder_.path() / "absent.yaml", loader, "absent.yaml");
  }
  const auto image = [&](const std::string& bytes, const char* why) {
    const std::filesystem::path yaml = map("\xFE");
    std::ofstream(folder_.path() / "map.pgm", std::ios::binary) << bytes;
    for (const MapLoader loader : both) expect_refused(yaml, loader, why);
  };
  image("P2\n1 1\n255\n0\n", "P5");
  image("P5\n2 2\n255\nabc", "last row");
  image("P5\n1 1\n65535\nab", "8 bits");
  image("P5\n0 1\n255\n", "header");
  image("P5\n", "header");
  image("P5\n1 1 # no end", "header");
  image("P5\n9999999999 1\n255\n", "header");
}

TEST_F(MapRules, TheFirstRowHasTheLargestYAndPlansComeBack) {
  OccupancyPlan plan;
  plan.width = 3;
  plan.height = 2;
  plan.resolution = 0.1;
  plan.origin = {-7.25, 0.1};
  plan.cells = {PlanCell::free,
                PlanCell::occupied,
                PlanCell::unknown,
                PlanCell::unknown,
                PlanCell::unknown,
                PlanCell::free};
  const std::filesystem::path yaml = write_plan(plan, folder_.path() / "plan");
  std::ifstream pgm(folder_.path() / "plan" / "map.pgm", std::ios::binary);
  const std::string bytes{std::istreambuf_iterator<char>(pgm), {}};
  EXPECT_EQ(static_cast<unsigned char>(bytes.back()), 205) << "unknown at the lower right";
  EXPECT_EQ(bytes[bytes.size() - 2], '\0') << "occupied at the lower middle";
  for (const MapLoader loader : both) {
    const OccupancyPlan back = as_amcl_sees(load_map(yaml, loader));
    EXPECT_EQ(back.cells, plan.cells);
    EXPECT_EQ(back.width, plan.width);
    EXPECT_EQ(back.resolution, plan.resolution);
    EXPECT_EQ(back.origin, plan.origin);
  }
}

TEST_F(MapRules, AnAbsoluteImagePathStaysWhatItIs) {
  const std::filesystem::path image = folder_.path() / "map.pgm";
  const std::filesystem::path yaml = map("\xFE", "image: " + image.string() + "\n");
  EXPECT_THAT(load_map(yaml, MapLoader::nav2).data, ElementsAre(0));
}

}  // namespace
}  // namespace kissmap
