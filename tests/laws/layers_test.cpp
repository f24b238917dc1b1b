// SPDX-License-Identifier: MIT
// The tree is the diagram: which part may include what.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <regex>
#include <string>
#include <vector>

namespace kissmap {
namespace {

namespace fs = std::filesystem;

const fs::path root = KISSMAP_SOURCE_DIR;

/// "file: included" for every include below a folder that matches.
std::vector<std::string> includes_matching(const fs::path& folder, const std::string& pattern) {
  const std::regex include(R"(\s*#\s*include\s*[<"]([^>"]+)[>"].*)");
  const std::regex wanted(pattern);
  std::vector<std::string> found;
  for (const fs::directory_entry& entry : fs::recursive_directory_iterator(folder)) {
    const std::string extension = entry.path().extension();
    if (extension != ".cpp" && extension != ".hpp" && extension != ".in") continue;
    std::ifstream in(entry.path());
    for (std::string line; std::getline(in, line);) {
      std::smatch match;
      if (std::regex_match(line, match, include) && std::regex_search(match[1].str(), wanted)) {
        found.push_back(fs::relative(entry.path(), root).string() + ": " + match[1].str());
      }
    }
  }
  return found;
}

using testing::IsEmpty;
using testing::Not;

TEST(Layers, TheSearchFindsIncludes) {
  EXPECT_THAT(includes_matching(root / "src", "kissmap/error.hpp"), Not(IsEmpty()));
}

TEST(Layers, CoreSeesNoFormats) {
  EXPECT_THAT(includes_matching(root / "src", "formats/"), IsEmpty());
  for (const char* room : {"geometry",
                           "parallel",
                           "cloud",
                           "odometry",
                           "mapping",
                           "graph",
                           "loop_closing",
                           "occupancy",
                           "evaluation"}) {
    EXPECT_THAT(includes_matching(root / "include/kissmap" / room, "formats/"), IsEmpty()) << room;
  }
}

TEST(Layers, LibrariesSeeNoProgramAndNoTests) {
  for (const char* layer : {"src", "include", "formats"}) {
    EXPECT_THAT(includes_matching(root / layer, "CLI/|gtest|gmock|support/|simulator/"), IsEmpty());
    EXPECT_THAT(includes_matching(root / layer, "commands.hpp|configuration.hpp"), IsEmpty());
  }
}

TEST(Layers, OnlyEigenAndStdCrossThePublicDoor) {
  // Standard headers have neither a slash nor a dot; the few with a slash are not used.
  const auto foreign = includes_matching(root / "include", R"(^(?!kissmap/)(?!Eigen/).*[./])");
  EXPECT_THAT(foreign, IsEmpty());
}

TEST(Layers, HeavyHeadersStayInSourceFiles) {
  const std::string heavy = "^(pcl|openvdb|octomap|opencv2|ceres|GeographicLib|zstd|png)";
  for (const char* layer : {"include", "src", "formats", "tools"}) {
    for (const std::string& include : includes_matching(root / layer, heavy)) {
      EXPECT_THAT(include, testing::HasSubstr(".cpp: ")) << "heavy header in a header";
    }
  }
}

}  // namespace
}  // namespace kissmap
