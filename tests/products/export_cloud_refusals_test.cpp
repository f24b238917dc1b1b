// SPDX-License-Identifier: MIT
// What kissmap export-cloud refuses, says of it, and leaves untouched.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>

#include "products/export_cloud.hpp"
#include "support/file_size_limit.hpp"
#include "support/folder_content.hpp"

namespace kissmap {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

TEST_F(ExportCloud, UsageErrorsSayWhatToDo) {
  make_session();
  std::ofstream(path("line.txt")) << "0 0\n1 x\n";
  std::ofstream(path("two.txt")) << "0 0\n1 1\n";
  const std::vector<std::tuple<std::string, std::vector<std::string>, int, std::string>> cases{
      {"cloud.xyz", {}, 2, ".pcd, .ply or .las"},
      {"cloud", {}, 2, "with --tiles to a folder"},
      {"cloud.pcd", {"--tiles", "20"}, 2, "folder"},
      {"tiles", {"--tiles", "0.5"}, 2, "--tiles"},
      {"tiles", {"--tiles", "0"}, 2, "--tiles"},
      {"tiles", {"--tiles", "20", "--voxel-size", "0"}, 2, "--voxel-size"},
      {"cloud.las", {"--compress"}, 2, "is for .pcd"},
      {"cloud.pcd", {"--voxel-size", "-1"}, 2, "--voxel-size"},
      {"cloud.pcd", {"--voxel-size", "nan"}, 2, "--voxel-size"},
      {"cloud.pcd", {"--voxel-size", "1e-9"}, 2, "too small"},
      {"cloud.pcd", {"--fields", "colour"}, 2, "'colour' is not one of"},
      {"cloud.pcd", {"--fields", "none,time"}, 2, "none alone"},
      {"cloud.pcd", {"--fields", "normals", "--voxel-size", "0"}, 2, "normals"},
      {"cloud.pcd", {"--remove-outliers", "--voxel-size", "0"}, 2, "--remove-outliers"},
      {"cloud.pcd", {"--crop", "1,2,3"}, 2, "xmin,ymin,xmax,ymax"},
      {"cloud.pcd", {"--crop", "1,2,3,x"}, 2, "xmin,ymin,xmax,ymax"},
      {"cloud.pcd", {"--crop", "5,0,1,1"}, 2, "xmin < xmax"},
      {"cloud.pcd", {"--crop", "900,900,901,901"}, 2, "no point"},
      {"cloud.las", {"--crop", "900,900,901,901", "--voxel-size", "0"}, 2, "no point"},
      {"cloud.pcd", {"--z-min", "3", "--z-max", "1"}, 2, "--z-min"},
      {"cloud.pcd", {"--color", "time"}, 2, "--color"},
      {"cloud.pcd", {"--crop-polygon", path("line.txt")}, 3, "line.txt:2: y"},
      {"cloud.pcd", {"--crop-polygon", path("two.txt")}, 3, "2 corners"},
      {"cloud.pcd", {"--crop-polygon", path("absent.txt")}, 3, "absent.txt"},
      {"absent/cloud.pcd", {}, 4, "create it first"},
      {"session/cloud.pcd", {}, 2, "inside the session"},
      {"log/scans/cloud.ply", {}, 2, "inside the log"},
      {"line.txt/cloud.ply", {}, 4, "no folder"},
  };
  const auto before = content_of(path(""));
  for (const auto& [output, more, code, message] : cases) {
    const ProgramResult result = run(output, more);
    EXPECT_EQ(result.exit_code, code) << output << " " << message << ": " << result.err;
    EXPECT_THAT(result.err, HasSubstr(message)) << output;
    EXPECT_THAT(result.err, Not(HasSubstr("internal")));
  }
  EXPECT_THAT(differing(before, content_of(path(""))), IsEmpty()) << "nothing is left behind";
}

TEST_F(ExportCloud, ReplacesOnlyWhenAsked) {
  make_session();
  std::ofstream(path("cloud.pcd")) << "old";
  const ProgramResult refused = run("cloud.pcd");
  EXPECT_EQ(refused.exit_code, 4);
  EXPECT_THAT(refused.err, HasSubstr("--overwrite"));
  EXPECT_EQ(file_text(path("cloud.pcd")), "old");
  fs::create_directory(path("folder.pcd"));
  EXPECT_EQ(run("folder.pcd", {"--overwrite"}).exit_code, 4);
  const ProgramResult quiet = run("cloud.pcd", {"--overwrite", "--quiet"});
  EXPECT_EQ(quiet.exit_code, 0);
  EXPECT_THAT(quiet.out + quiet.err, IsEmpty());
  EXPECT_GT(read_cloud(path("cloud.pcd")).rows.size(), 100U);
}

TEST_F(ExportCloud, AFullDiskIsAnOutputErrorAndLeavesNothing) {
  make_session();
  const auto before = content_of(path(""));
  for (const char* voxel_size : {"0", "0.02"}) {
    for (const std::string name : {"cloud.pcd", "cloud.ply", "cloud.las", "tiles"}) {
      std::vector<std::string> more{"--voxel-size", voxel_size};
      if (name == "tiles") more = {"--voxel-size", "0.02", "--tiles", "100"};
      const FileSizeLimit full(100'000);
      const ProgramResult result = run(name, more);
      EXPECT_EQ(result.exit_code, 4) << name;
      EXPECT_THAT(result.err, AllOf(HasSubstr(name), HasSubstr("free some space")));
    }
  }
  EXPECT_THAT(differing(before, content_of(path(""))), IsEmpty());
}

TEST_F(ExportCloud, FindsALogThatMovedAndTellsDamage) {
  make_session();
  EXPECT_EQ(kissmap({"export-cloud", path("absent"), "-o", path("a.pcd")}).exit_code, 3);
  fs::rename(path("log"), path("moved"));
  const ProgramResult lost = run("cloud.pcd");
  EXPECT_EQ(lost.exit_code, 3);
  EXPECT_THAT(lost.err, HasSubstr("--log"));
  EXPECT_GT(cloud("cloud.pcd", {"--log", path("moved")}).rows.size(), 100U);
  const fs::path scan = *fs::directory_iterator(path("moved") / "scans");
  std::fstream file(scan, std::ios::in | std::ios::out | std::ios::binary);
  file.seekp(-3, std::ios::end);
  file.put('\x7f');
  file.close();
  const ProgramResult damaged = run("damaged.pcd", {"--log", path("moved")});
  EXPECT_EQ(damaged.exit_code, 3) << damaged.err;
  EXPECT_FALSE(fs::exists(path("damaged.pcd")));
}

TEST_F(ExportCloud, LogsWithoutIntensitiesOrStampsSaySo) {
  fs::create_directory(path("bare"));
  for (int i = 0; i < 3; ++i) {
    std::ofstream out(path("bare") / ("scan" + std::to_string(i) + ".pcd"));
    out << "VERSION 0.7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\nWIDTH 3\nHEIGHT 1\n"
           "VIEWPOINT 0 0 0 1 0 0 0\nPOINTS 3\nDATA ascii\n1 2 3\n4 5 6\n7 8 "
        << i << "\n";
  }
  write_true_session(path("bare"), path("session"), [](const Scan& scan) {
    MappedScan mapped;
    mapped.stamp_ns = mapped.pose_stamp_ns = scan.stamp_ns;
    return mapped;
  });
  EXPECT_THAT(cloud("cloud.pcd").names, ElementsAre("x", "y", "z"));
  EXPECT_EQ(cloud("all.las", {"--voxel-size", "0"}).rows.size(), 9U);
  const ProgramResult intensity = run("b.pcd", {"--fields", "intensity"});
  EXPECT_EQ(intensity.exit_code, 3);
  EXPECT_THAT(intensity.err, HasSubstr("has no intensities"));
  const ProgramResult time = run("c.pcd", {"--fields", "time"});
  EXPECT_EQ(time.exit_code, 2);
  EXPECT_THAT(time.err, HasSubstr("no stamps"));
}

}  // namespace
}  // namespace kissmap
