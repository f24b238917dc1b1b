// SPDX-License-Identifier: MIT
// The cloud of its own that kissmap export-cloud --remove-dynamic makes of what moved.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <set>

#include "products/export_cloud.hpp"

namespace kissmap {
namespace {

using testing::HasSubstr;

TEST_F(ExportCloud, WhatMovedGoesIntoACloudOfItsOwn) {
  make_session();
  const std::vector<std::string> all_points{"--voxel-size", "0", "--fields", "intensity,time,scan"};
  std::vector<std::string> without = all_points;
  without.emplace_back("--remove-dynamic");
  std::multiset<std::vector<double>> all;
  for (const auto& row : cloud("all.pcd", all_points).rows) all.insert(row);
  const ProgramResult result = run("still.pcd", without);
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const CloudTable still = read_cloud(path("still.pcd"));
  const CloudTable removed = read_cloud(path("still_removed.pcd"));
  EXPECT_GT(removed.rows.size(), 0U);
  EXPECT_LT(removed.rows.size(), all.size() / 20);
  EXPECT_EQ(still.names, removed.names);
  std::multiset<std::vector<double>> both;
  for (const CloudTable* table : {&still, &removed}) {
    for (const auto& row : table->rows) both.insert(row);
  }
  EXPECT_TRUE(both == all) << both.size() << " and " << all.size();
  EXPECT_THAT(result.out, HasSubstr("still_removed.pcd"));
  EXPECT_THAT(result.out, HasSubstr(std::to_string(removed.rows.size()) + " points, in "));
}

TEST_F(ExportCloud, WhatMovedIsTheSameInAnyFormatAndForAnyThreads) {
  make_session();
  std::size_t count = 0;
  for (const std::string ending : {".pcd", ".ply", ".las"}) {
    const CloudTable still =
        cloud("map" + ending, {"--voxel-size", "0.2", "--remove-dynamic", "--threads", "1"});
    const CloudTable removed = read_cloud(path("map_removed" + ending));
    if (count == 0) count = removed.rows.size();
    EXPECT_EQ(removed.rows.size(), count) << ending;
    EXPECT_GT(still.rows.size(), count) << ending;
    cloud("again" + ending, {"--voxel-size", "0.2", "--remove-dynamic", "--threads", "3"});
    EXPECT_EQ(file_text(path("map_removed" + ending)), file_text(path("again_removed" + ending)));
    EXPECT_EQ(file_text(path("map" + ending)), file_text(path("again" + ending)));
  }
  const std::vector<std::string> tiles{"--voxel-size", "0.2", "--tiles", "20", "--remove-dynamic"};
  ASSERT_EQ(run("tiles", tiles).exit_code, 0);
  EXPECT_EQ(read_cloud(path("tiles_removed.pcd")).rows.size(), count);
}

TEST_F(ExportCloud, ACloudOfWhatMovedIsReplacedOnlyWhenAsked) {
  make_session();
  std::ofstream(path("map_removed.pcd")) << "mine";
  const ProgramResult refused = run("map.pcd", {"--remove-dynamic"});
  EXPECT_EQ(refused.exit_code, 4);
  EXPECT_THAT(refused.err, HasSubstr("map_removed.pcd"));
  EXPECT_FALSE(fs::exists(path("map.pcd")));
  EXPECT_EQ(file_text(path("map_removed.pcd")), "mine");
  EXPECT_EQ(run("map.pcd", {"--remove-dynamic", "--overwrite"}).exit_code, 0);
  EXPECT_NE(file_text(path("map_removed.pcd")), "mine");
}

}  // namespace
}  // namespace kissmap
