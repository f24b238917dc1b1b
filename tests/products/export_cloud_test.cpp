// SPDX-License-Identifier: MIT
// What kissmap export-cloud writes: points, voxels, crops, tiles, fields.
#include "products/export_cloud.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <set>

#include "support/folder_content.hpp"

namespace kissmap {
namespace {

using simulator::Simulator;
using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

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

TEST(Program, LoadsNeitherVtkNorGdal) {
  const ProgramResult libraries = run_program({"ldd", KISSMAP_BINARY});
  EXPECT_THAT(libraries.out, HasSubstr("libpcl_common"));
  EXPECT_THAT(libraries.out, AllOf(Not(HasSubstr("vtk")), Not(HasSubstr("gdal"))));
}

}  // namespace
}  // namespace kissmap
