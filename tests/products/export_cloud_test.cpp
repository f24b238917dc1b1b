// SPDX-License-Identifier: MIT
// kissmap export-cloud, as a user calls it, on a simulated session whose trajectory is the truth.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <set>

#include "kissmap/cloud/scan.hpp"
#include "products/cloud_table.hpp"
#include "products/true_session.hpp"
#include "simulator/log_folder.hpp"
#include "simulator/scenario.hpp"
#include "support/file_size_limit.hpp"
#include "support/folder_content.hpp"
#include "support/small_log.hpp"
#include "support/temp_dir.hpp"

namespace kissmap {
namespace {

namespace fs = std::filesystem;
using simulator::Simulator;
using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

constexpr double max_range = 30.0;

ProgramResult kissmap(std::vector<std::string> arguments) {
  arguments.insert(arguments.begin(), KISSMAP_BINARY);
  return run_program(arguments);
}

simulator::Scenario short_tour() {
  simulator::Scenario scenario{"office", "spinning16", "robot", 1, 20};
  scenario.columns = 150;
  return scenario;
}

class ExportCloud : public testing::Test {
 protected:
  fs::path path(const std::string& name) const { return folder_.path() / name; }

  void make_session(const std::string& name = "session",
                    const Eigen::Vector3d& shift = Eigen::Vector3d::Zero()) const {
    if (!fs::exists(path("log"))) {
      simulator::write_log_folder(simulator_, path("log"), 1, [](std::size_t) {});
    }
    Rigid3 map_from_world;
    map_from_world.translation = shift;
    write_true_session(path("log"), path(name), [&](const Scan& scan) {
      return true_place(simulator_, scan, map_from_world);
    });
  }

  ProgramResult run(const std::string& output,
                    std::vector<std::string> more = {},
                    const std::string& session = "session") const {
    more.insert(more.begin(), {"export-cloud", path(session), "-o", path(output)});
    return kissmap(more);
  }
  CloudTable cloud(const std::string& output,
                   const std::vector<std::string>& more = {},
                   const std::string& session = "session") const {
    const ProgramResult result = run(output, more, session);
    EXPECT_EQ(result.exit_code, 0) << result.err;
    return read_cloud(path(output));
  }

  Simulator simulator_ = simulator::make_simulator(short_tour());

 private:
  TempDir folder_;
};

Eigen::Vector3d vector_at(const CloudTable& table, std::size_t row, const std::string& prefix) {
  return {table.at(row, prefix + "x"), table.at(row, prefix + "y"), table.at(row, prefix + "z")};
}

double seconds_since_start(double stamp) {
  return stamp - 1e-9 * static_cast<double>(Simulator::first_stamp_ns);
}

TEST_F(ExportCloud, PointsLieOnTheSurfacesAndWereSeenFromTheSensor) {
  make_session();
  const CloudTable table =
      cloud("cloud.pcd", {"--voxel-size", "0", "--fields", "intensity,time,scan,sensor"});
  std::size_t wanted = 0;
  for (std::size_t i = 0; i < simulator_.scan_count(); ++i) {
    for (const Eigen::Vector3f& point : simulator_.scan(i).points) {
      wanted += point.norm() > 0.52F && point.norm() < 29.9F ? 1 : 0;
    }
  }
  EXPECT_NEAR(static_cast<double>(table.rows.size()), static_cast<double>(wanted), 20.0);
  ASSERT_GT(table.rows.size(), 20'000U);
  std::size_t off = 0;
  double squares = 0.0;
  double worst_sensor = 0.0;
  for (std::size_t i = 0; i < table.rows.size(); ++i) {
    const double time = seconds_since_start(table.at(i, "timestamp"));
    const double error = simulator_.caster().distance(vector_at(table, i, ""), time);
    off += std::abs(error) > 0.1 ? 1 : 0;
    squares += error * error;
    const auto stamp = Simulator::first_stamp_ns + std::llround(1e9 * time);
    worst_sensor = std::max(
        worst_sensor,
        (simulator_.map_from_lidar(stamp).translation - vector_at(table, i, "vp_")).norm());
    ASSERT_EQ(table.at(i, "scan"), std::floor(time * 10.0 + 1e-6)) << "sweeps of 0.1 s";
  }
  EXPECT_EQ(off, 0U) << "of " << table.rows.size();
  EXPECT_LT(std::sqrt(squares / static_cast<double>(table.rows.size())), 0.021)
      << "noise of 2 cm along the beam";
  EXPECT_LT(worst_sensor, 0.005);
}

std::array<long, 3> voxel_at(const CloudTable& table, std::size_t row, double size) {
  return {std::lround(std::floor(table.at(row, "x") / size)),
          std::lround(std::floor(table.at(row, "y") / size)),
          std::lround(std::floor(table.at(row, "z") / size))};
}

bool is_at_a_border(const CloudTable& table, std::size_t row, double size) {
  for (const char* axis : {"x", "y", "z"}) {
    const double place = table.at(row, axis) / size;
    if (std::abs(place - std::round(place)) < 1e-4) return true;  // single precision may cross it
  }
  return false;
}

TEST_F(ExportCloud, ThinningKeepsOneRealPointInEachVoxel) {
  make_session();
  const CloudTable all = cloud("all.ply", {"--voxel-size", "0", "--fields", "intensity,time"});
  constexpr double size = 0.2;
  const CloudTable thinned =
      cloud("thinned.ply", {"--voxel-size", "0.2", "--fields", "intensity,time"});
  std::set<std::array<long, 3>> voxels;
  for (std::size_t i = 0; i < all.rows.size(); ++i) {
    if (!is_at_a_border(all, i, size)) voxels.insert(voxel_at(all, i, size));
  }
  const std::set<std::vector<double>> real(all.rows.begin(), all.rows.end());
  std::set<std::array<long, 3>> found;
  for (std::size_t i = 0; i < thinned.rows.size(); ++i) {
    ASSERT_TRUE(real.contains(thinned.rows[i])) << "row " << i << " is no point of the log";
    if (is_at_a_border(thinned, i, size)) continue;
    ASSERT_TRUE(found.insert(voxel_at(thinned, i, size)).second) << "a voxel with two points";
  }
  EXPECT_LT(thinned.rows.size(), all.rows.size() / 2);
  std::size_t missing = 0;
  for (const auto& voxel : voxels) missing += found.contains(voxel) ? 0 : 1;
  EXPECT_LE(missing, voxels.size() / 500) << "but for points kept at a border";
  // The default is a thousandth of the range.
  EXPECT_EQ(cloud("default.ply").rows.size(),
            cloud("3cm.ply", {"--voxel-size", "0.03"}).rows.size());
}

TEST_F(ExportCloud, TheSameBytesOnEveryRunAndForAnyThreads) {
  make_session();
  const std::vector<std::string> everything{"--voxel-size",
                                            "0.1",
                                            "--fields",
                                            "intensity,time,normals,scan,sensor",
                                            "--color",
                                            "height",
                                            "--remove-outliers"};
  for (const std::string name : {"cloud.pcd", "packed.pcd", "cloud.ply", "cloud.las", "tiles"}) {
    std::vector<std::map<std::string, std::string>> contents;
    for (const char* threads : {"1", "4", "4"}) {
      std::vector<std::string> more = everything;
      more.insert(more.end(), {"--threads", threads, "--overwrite"});
      if (name == "tiles") more.insert(more.end(), {"--tiles", "5"});
      if (name == "packed.pcd") more.push_back("--compress");
      const ProgramResult result = run(name, more);
      ASSERT_EQ(result.exit_code, 0) << result.err;
      contents.push_back(name == "tiles"
                             ? content_of(path(name))
                             : std::map<std::string, std::string>{{name, file_text(path(name))}});
    }
    EXPECT_GT(contents[0].begin()->second.size(), 20U);
    EXPECT_THAT(differing(contents[0], contents[1]), IsEmpty()) << name;
    EXPECT_THAT(differing(contents[1], contents[2]), IsEmpty()) << name;
  }
}

TEST_F(ExportCloud, CropsToBoxPolygonAndHeights) {
  make_session();
  const CloudTable all = cloud("all.pcd", {"--voxel-size", "0", "--fields", "time"});
  const Eigen::Vector3d middle = simulator_.map_from_lidar(Simulator::first_stamp_ns).translation;
  const auto number = [](double value) { return std::to_string(value); };
  const double x = middle.x() - 1.50005;
  const double y = middle.y() - 1.00005;
  const std::string box =
      "--crop=" + number(x) + "," + number(y) + "," + number(x + 3.5) + "," + number(y + 3.0);
  std::ofstream(path("polygon.txt")) << "# a box\n"
                                     << x << ", " << y << "\n"
                                     << x + 3.5 << " " << y << "\n\n"
                                     << x + 3.5 << " " << y + 3.0 << "  # far corner\n"
                                     << x << " " << y + 3.0 << "\n"
                                     << x << " " << y << "\n";
  const std::vector<std::string> rest{
      "--z-min=0.10005", "--z-max=2.00005", "--voxel-size", "0", "--fields", "time"};
  std::vector<std::string> by_box = rest;
  by_box.push_back(box);
  std::vector<std::string> by_polygon = rest;
  by_polygon.insert(by_polygon.end(), {"--crop-polygon", path("polygon.txt")});
  const CloudTable cropped = cloud("box.pcd", by_box);
  std::vector<std::vector<double>> wanted;
  for (std::size_t i = 0; i < all.rows.size(); ++i) {
    const Eigen::Vector3d p = vector_at(all, i, "");
    if (p.x() > x && p.x() < x + 3.5 && p.y() > y && p.y() < y + 3.0 && p.z() > 0.10005 &&
        p.z() < 2.00005) {
      wanted.push_back(all.rows[i]);
    }
  }
  ASSERT_GT(wanted.size(), 100U);
  ASSERT_LT(wanted.size(), all.rows.size() * 9 / 10);
  EXPECT_EQ(cropped.rows, wanted);
  EXPECT_EQ(cloud("polygon.pcd", by_polygon).rows.size(), wanted.size());
}

TEST_F(ExportCloud, TilesHoldWhatOneFileHolds) {
  make_session();
  const CloudTable whole = cloud("whole.pcd", {"--voxel-size", "0.1"});
  const ProgramResult result = run("tiles/", {"--voxel-size", "0.1", "--tiles", "5"});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_THAT(result.out, HasSubstr(" of 5 m"));
  EXPECT_TRUE(fs::exists(path("tiles") / "pointcloud_map_metadata.yaml"));
  std::vector<std::vector<double>> rows;
  for (const auto& entry : fs::directory_iterator(path("tiles"))) {
    if (entry.path().extension() != ".pcd") continue;
    const CloudTable tile = read_cloud(entry.path());
    rows.insert(rows.end(), tile.rows.begin(), tile.rows.end());
  }
  std::vector<std::vector<double>> wanted = whole.rows;
  std::ranges::sort(wanted);
  std::ranges::sort(rows);
  EXPECT_EQ(rows, wanted);
}

TEST_F(ExportCloud, FarMapsKeepTheirMillimetres) {
  const Eigen::Vector3d shift(450'000.0, 5'411'000.0, 120.0);
  make_session();
  make_session("far", shift);
  const std::vector<std::string> options{"--voxel-size", "0", "--fields", "time"};
  const CloudTable near_las = cloud("near.las", options);
  const CloudTable far_las = cloud("far.las", options, "far");
  const CloudTable near_pcd = cloud("near.pcd", options);
  const ProgramResult result = run("far.pcd", options, "far");
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_THAT(result.out, HasSubstr("far.pcd.offset.txt"));
  EXPECT_FALSE(fs::exists(path("near.pcd.offset.txt")));
  EXPECT_FALSE(fs::exists(path("far.las.offset.txt"))) << "LAS has a place of its own";
  std::istringstream text(file_text(path("far.pcd.offset.txt")));
  std::string remark;
  Eigen::Vector3d offset;
  std::getline(text, remark);
  text >> offset.x() >> offset.y() >> offset.z();
  const CloudTable far_pcd = read_cloud(path("far.pcd"));
  ASSERT_EQ(far_pcd.rows.size(), near_pcd.rows.size());
  ASSERT_EQ(far_las.rows.size(), near_las.rows.size());
  for (std::size_t i = 0; i < near_pcd.rows.size(); ++i) {
    const Eigen::Vector3d point = vector_at(near_pcd, i, "") + shift;
    ASSERT_LT((vector_at(far_pcd, i, "") + offset - point).norm(), 1e-3);
    ASSERT_LT((vector_at(far_las, i, "") - vector_at(near_las, i, "") - shift).norm(), 2e-3);
    ASSERT_LT((vector_at(far_las, i, "") - point).norm(), 1e-3);
  }
  // A near map in the place of a far one takes its offset away.
  EXPECT_EQ(run("far.pcd", {"--overwrite"}).exit_code, 0);
  EXPECT_FALSE(fs::exists(path("far.pcd.offset.txt")));
}

TEST_F(ExportCloud, FieldsNormalsColoursAndOutliers) {
  make_session();
  EXPECT_THAT(cloud("default.pcd").names, ElementsAre("x", "y", "z", "intensity"));
  EXPECT_THAT(cloud("none.pcd", {"--fields", "none"}).names, ElementsAre("x", "y", "z"));
  const CloudTable coloured = cloud("colour.ply", {"--color", "height", "--fields", "none"});
  const auto highest = std::ranges::max_element(
      coloured.rows, {}, [](const std::vector<double>& row) { return row[2]; });
  const auto lowest = std::ranges::min_element(
      coloured.rows, {}, [](const std::vector<double>& row) { return row[2]; });
  EXPECT_GT((*highest)[3], (*lowest)[3]) << "yellow above blue: red";
  EXPECT_LT((*highest)[5], (*lowest)[5]) << "yellow above blue: blue";
  const CloudTable normals = cloud("normals.ply", {"--voxel-size", "0.2", "--fields", "normals"});
  std::size_t upright = 0;
  std::size_t floor = 0;
  for (std::size_t i = 0; i < normals.rows.size(); ++i) {
    if (std::abs(normals.at(i, "z")) > 0.05 || std::isnan(normals.at(i, "nz"))) continue;
    ++floor;
    upright += normals.at(i, "nz") > 0.9 ? 1 : 0;
  }
  EXPECT_GT(floor, 200U);
  EXPECT_GT(upright, floor * 8 / 10) << "but for the feet of walls and furniture";
  const std::size_t before = cloud("before.pcd", {"--voxel-size", "0.1"}).rows.size();
  const std::size_t after =
      cloud("after.pcd", {"--voxel-size", "0.1", "--remove-outliers"}).rows.size();
  EXPECT_LT(after, before);
  EXPECT_GT(after, before * 9 / 10);
}

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

TEST(Program, LoadsNeitherVtkNorGdal) {
  const ProgramResult libraries = run_program({"ldd", KISSMAP_BINARY});
  EXPECT_THAT(libraries.out, HasSubstr("libpcl_common"));
  EXPECT_THAT(libraries.out, AllOf(Not(HasSubstr("vtk")), Not(HasSubstr("gdal"))));
}

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
