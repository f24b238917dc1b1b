// SPDX-License-Identifier: MIT
// kissmap export-voxels, as a user calls it, on a yard mapped by the real binary.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <set>

#include "kissmap/geometry/rigid3.hpp"
#include "products/cloud_table.hpp"
#include "products/true_session.hpp"
#include "support/folder_content.hpp"
#include "support/temp_dir.hpp"
#include "support/yard_log.hpp"

namespace kissmap {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::HasSubstr;

constexpr double voxel_size = 0.2;

ProgramResult kissmap(std::vector<std::string> arguments) {
  arguments.insert(arguments.begin(), KISSMAP_BINARY);
  return run_program(arguments);
}

class ExportVoxels : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    shared_ = new TempDir;
    write_yard_log(shared_->path() / "log", 20);
    const ProgramResult result = kissmap(
        {"run", shared_->path() / "log", "-o", shared_->path() / "session", "--no-products"});
    ASSERT_EQ(result.exit_code, 0) << result.err;
  }
  static void TearDownTestSuite() {
    delete shared_;
    shared_ = nullptr;
  }

  static fs::path session() { return shared_->path() / "session"; }
  fs::path path(const std::string& name) const { return folder_.path() / name; }
  ProgramResult exported(const std::string& name, std::vector<std::string> more = {}) const {
    std::vector<std::string> arguments = {"export-voxels", session(), "-o", path(name)};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return kissmap(arguments);
  }

  CloudTable exported_points(const std::string& name, const std::string& frame) const;

  TempDir folder_;
  inline static TempDir* shared_ = nullptr;
};

/// The pose a report names in the line after "x y z qx qy qz qw".
Rigid3 frame_from_map(const std::string& report) {
  std::istringstream rest(report.substr(report.find("qw\n") + 3));
  Rigid3 pose;
  auto& t = pose.translation;
  auto& q = pose.rotation;
  rest >> t.x() >> t.y() >> t.z() >> q.x() >> q.y() >> q.z() >> q.w();
  EXPECT_TRUE(rest);
  EXPECT_NEAR(q.norm(), 1.0, 1e-6);
  return pose;
}

Eigen::Vector3d position(const CloudTable& cloud, std::size_t row) {
  return {cloud.at(row, "x"), cloud.at(row, "y"), cloud.at(row, "z")};
}

CloudTable ExportVoxels::exported_points(const std::string& name, const std::string& frame) const {
  const ProgramResult result =
      kissmap({"export-cloud", session(), "-o", path(name), "--voxel-size", "0", "--frame", frame});
  EXPECT_EQ(result.exit_code, 0) << result.err;
  return read_cloud(path(name));
}

using Indices = std::array<int, 3>;

Indices indices(const Eigen::Vector3d& point) {
  const Eigen::Vector3d floor = (point / voxel_size).array().floor();
  return {static_cast<int>(floor.x()), static_cast<int>(floor.y()), static_cast<int>(floor.z())};
}

TEST_F(ExportVoxels, OccupiedVoxelsAreWhereTheExportedPointsAre) {
  for (const std::string frame : {"level", "map"}) {
    const ProgramResult voxels =
        exported("v_" + frame + ".ply", {"--resolution", "0.2", "--frame", frame});
    ASSERT_EQ(voxels.exit_code, 0) << voxels.err;
    EXPECT_THAT(file_text(path("v_" + frame + ".ply")).substr(0, 200), HasSubstr("frame " + frame));
    const CloudTable points = exported_points("p_" + frame + ".pcd", frame);
    std::set<Indices> seen;
    for (std::size_t i = 0; i < points.rows.size(); ++i) {
      // The file's single precision may put a point on the other side of a face.
      for (const double x : {-1e-4, 1e-4}) {
        for (const double y : {-1e-4, 1e-4}) {
          for (const double z : {-1e-4, 1e-4}) {
            seen.insert(indices(position(points, i) + Eigen::Vector3d(x, y, z)));
          }
        }
      }
    }
    const CloudTable centers = read_cloud(path("v_" + frame + ".ply"));
    ASSERT_GT(centers.rows.size(), 5000U);
    for (std::size_t i = 0; i < centers.rows.size(); ++i) {
      ASSERT_TRUE(seen.contains(indices(position(centers, i)))) << position(centers, i).transpose();
    }
  }
}

TEST_F(ExportVoxels, TheReportSaysHowTheFramesLie) {
  const ProgramResult level = exported("v.bt");
  const ProgramResult map = exported("w.bt", {"--frame", "map"});
  ASSERT_EQ(map.exit_code, 0) << map.err;
  EXPECT_THAT(map.out, testing::Not(HasSubstr("frame")));
  const Rigid3 level_from_map = frame_from_map(level.out);
  const CloudTable in_level = exported_points("p.pcd", "level");
  const CloudTable in_map = exported_points("q.pcd", "map");
  ASSERT_EQ(in_level.rows.size(), in_map.rows.size());
  for (std::size_t i = 0; i < in_map.rows.size(); i += 97) {
    ASSERT_LT((level_from_map * position(in_map, i) - position(in_level, i)).norm(), 1e-3);
  }
}

TEST_F(ExportVoxels, AMapInPartsIsTheMapInOne) {
  for (const std::string ending : {".bt", ".ot", ".vdb"}) {
    const ProgramResult whole = exported("whole" + ending);
    const ProgramResult parts = exported("parts" + ending, {"--max-memory", "0.001"});
    ASSERT_EQ(parts.exit_code, 0) << parts.err;
    EXPECT_THAT(whole.out, testing::Not(HasSubstr("passes")));
    EXPECT_THAT(parts.out, HasSubstr("passes over the log"));
    EXPECT_EQ(file_text(path("parts" + ending)), file_text(path("whole" + ending))) << ending;
  }
  // A grid's own cells have to fit; the voxels of a band this high need not.
  const auto grid = [&](const std::string& name, const std::string& memory) {
    const ProgramResult result = kissmap({"export-grid",
                                          session(),
                                          "-o",
                                          path(name),
                                          "--resolution",
                                          "0.1",
                                          "--z-max",
                                          "5",
                                          "--max-memory",
                                          memory});
    ASSERT_EQ(result.exit_code, 0) << result.err;
  };
  grid("whole", "4");
  grid("parts", "0.022");
  EXPECT_EQ(file_text(path("parts.pgm")), file_text(path("whole.pgm")));
}

TEST_F(ExportVoxels, OctomapsReachIsToldBeforeTheWork) {
  write_true_session(shared_->path() / "log", path("far"), [](const Scan& scan) {
    MappedScan mapped;
    mapped.stamp_ns = mapped.pose_stamp_ns = scan.stamp_ns;
    mapped.map_from_lidar.translation = {0.0, 4000.0, 0.0};
    mapped.local_map_from_lidar = mapped.map_from_lidar;
    return mapped;
  });
  const auto far = [&](const std::string& name, const std::string& resolution) {
    return kissmap({"export-voxels",
                    path("far"),
                    "-o",
                    path(name),
                    "--resolution",
                    resolution,
                    "--frame",
                    "map"});
  };
  const ProgramResult refused = far("far.bt", "0.1");
  EXPECT_EQ(refused.exit_code, 2);
  EXPECT_THAT(refused.err, AllOf(HasSubstr("--resolution"), HasSubstr(".vdb")));
  EXPECT_FALSE(fs::exists(path("far.bt")));
  EXPECT_EQ(far("far.bt", "0.2").exit_code, 0);
}

TEST_F(ExportVoxels, TheGroundIsAtZero) {
  ASSERT_EQ(exported("v.pcd", {"--resolution", "0.2"}).exit_code, 0);
  const CloudTable centers = read_cloud(path("v.pcd"));
  std::map<int, int> layers;
  for (std::size_t i = 0; i < centers.rows.size(); ++i) ++layers[indices(position(centers, i))[2]];
  const int ground = layers[-1] + layers[0];
  for (const auto& [layer, count] : layers) {
    if (layer >= -2 && layer <= 1) continue;  // the ground, and beside it
    EXPECT_LT(count, ground / 4) << layer;
  }
}

TEST_F(ExportVoxels, AreTheSameForAnyNumberOfThreads) {
  for (const std::string ending : {".bt", ".ot", ".vdb", ".pcd"}) {
    ASSERT_EQ(exported("one" + ending, {"--threads", "1"}).exit_code, 0);
    ASSERT_EQ(exported("three" + ending, {"--threads", "3"}).exit_code, 0);
    EXPECT_EQ(file_text(path("one" + ending)), file_text(path("three" + ending))) << ending;
    EXPECT_GT(fs::file_size(path("one" + ending)), 1000U) << ending;
  }
}

TEST_F(ExportVoxels, ChoosesACoarseResolutionOutdoors) {
  const ProgramResult voxels = exported("v.bt");
  ASSERT_EQ(voxels.exit_code, 0) << voxels.err;
  EXPECT_THAT(voxels.out, HasSubstr("of 0.2 m"));
}

TEST_F(ExportVoxels, AHigherThresholdLeavesFewerVoxels) {
  std::size_t before = 0;
  for (const char* threshold : {"0.9", "0.6", "0.5"}) {
    ASSERT_EQ(exported("v.pcd", {"--threshold", threshold, "--overwrite"}).exit_code, 0);
    const CloudTable cloud = read_cloud(path("v.pcd"));
    for (std::size_t i = 0; i < cloud.rows.size(); ++i) {
      ASSERT_GT(cloud.at(i, "intensity"), std::stod(threshold));
    }
    EXPECT_GT(cloud.rows.size(), before) << threshold;
    before = cloud.rows.size();
  }
}

TEST_F(ExportVoxels, ReportsWhatIsInTheFile) {
  const ProgramResult result = exported("v.pcd", {"--resolution", "0.2"});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const std::string count = std::to_string(read_cloud(path("v.pcd")).rows.size());
  const std::string with_comma =
      count.substr(0, count.size() - 3) + "," + count.substr(count.size() - 3);
  EXPECT_THAT(result.out, AllOf(HasSubstr(with_comma + " occupied"), HasSubstr("35 scans")));
  EXPECT_EQ(exported("quiet.bt", {"--quiet"}).out, "");
}

TEST_F(ExportVoxels, RefusesWithTheRightExitCode) {
  const auto expect = [&](const ProgramResult& result, int code, const char* says) {
    EXPECT_EQ(result.exit_code, code) << result.err;
    EXPECT_THAT(result.err, HasSubstr(says));
  };
  expect(exported("v"), 2, ".bt");
  expect(exported("v.las"), 2, ".vdb");
  for (const char* resolution : {"0.001", "-1", "11", "nan", "inf"}) {
    expect(exported("v.bt", {"--resolution", resolution}), 2, "resolution");
  }
  for (const char* threshold : {"0", "1", "0.98", "nan"}) {
    expect(exported("v.bt", {"--threshold", threshold}), 2, "threshold");
  }
  expect(exported("v.bt", {"--no-return-range", "-1"}), 2, "no-return-range");
  expect(exported("v.bt", {"--frame", "enu"}), 2, "frame");
  for (const char* memory : {"0", "-4", "nan"}) {
    expect(exported("v.bt", {"--max-memory", memory}), 2, "max-memory");
    expect(kissmap({"export-grid", session(), "-o", path("g"), "--max-memory", memory}),
           2,
           "max-memory");
  }
  expect(exported("absent/v.bt"), 4, "absent");
  expect(kissmap({"export-voxels", path("none"), "-o", path("v.bt")}), 3, "none");
  expect(kissmap({"export-voxels", session(), "-o", session() / "v.bt"}), 2, "session");
  EXPECT_TRUE(fs::is_empty(folder_.path()));
}

TEST_F(ExportVoxels, ReplacesOnlyWhenTold) {
  std::ofstream(path("v.bt")) << "mine";
  const ProgramResult refused = exported("v.bt");
  EXPECT_EQ(refused.exit_code, 4);
  EXPECT_THAT(refused.err, HasSubstr("--overwrite"));
  EXPECT_EQ(file_text(path("v.bt")), "mine");
  EXPECT_EQ(exported("v.bt", {"--overwrite"}).exit_code, 0);
  EXPECT_THAT(file_text(path("v.bt")), testing::StartsWith("# Octomap OcTree binary file"));
}

}  // namespace
}  // namespace kissmap
