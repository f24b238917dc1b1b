// SPDX-License-Identifier: MIT
// Programs of others read the products of the real binary.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <sstream>

#include "products/cloud_table.hpp"
#include "support/temp_dir.hpp"
#include "support/yard_log.hpp"

namespace kissmap {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

ProgramResult kissmap(std::vector<std::string> arguments) {
  arguments.insert(arguments.begin(), KISSMAP_BINARY);
  return run_program(arguments);
}

class ProductClients : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    shared_ = new TempDir;
    write_yard_log(shared_->path() / "log", 20);
    const ProgramResult result =
        kissmap({"run", shared_->path() / "log", "-o", shared_->path() / "session"});
    ASSERT_EQ(result.exit_code, 0) << result.err;
  }
  static void TearDownTestSuite() {
    delete shared_;
    shared_ = nullptr;
  }

  static fs::path session() { return shared_->path() / "session"; }
  static fs::path product(const std::string& name) { return session() / "products" / name; }
  fs::path path(const std::string& name) const { return folder_.path() / name; }

  void export_cloud(const std::string& name, std::vector<std::string> more) const {
    more.insert(more.begin(), {"export-cloud", session(), "-o", path(name)});
    const ProgramResult result = kissmap(more);
    ASSERT_EQ(result.exit_code, 0) << result.err;
  }

  TempDir folder_;
  inline static TempDir* shared_ = nullptr;
};

std::vector<std::vector<double>> rows_of(const std::string& text) {
  std::vector<std::vector<double>> rows;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    std::istringstream words(line);
    std::vector<double>& row = rows.emplace_back();
    for (std::string word; words >> word;) row.push_back(std::strtod(word.c_str(), nullptr));
  }
  return rows;
}

bool same(double a, double b) {
  return (std::isnan(a) && std::isnan(b)) || std::abs(a - b) <= 1e-6 * std::max(1.0, std::abs(b));
}

/// A program in Debian's Python with nothing but Debian's modules: -I leaves out the user's own.
ProgramResult python(std::vector<std::string> arguments) {
  arguments.insert(arguments.begin(), {KISSMAP_TEST_PYTHON, "-I"});
  return run_program(arguments);
}

/// Open3D has to find what the reader written from the specifications finds.
void expect_open3d_reads(const fs::path& file, const std::vector<std::string>& columns) {
  const ProgramResult result = python({KISSMAP_CLIENT_SOURCES "/read_open3d.py", file});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const std::vector<std::vector<double>> found = rows_of(result.out);
  const CloudTable expected = read_cloud(file);
  ASSERT_GT(expected.rows.size(), 1000U) << file;
  ASSERT_EQ(found.size(), expected.rows.size()) << file;
  for (std::size_t i = 0; i < found.size(); ++i) {
    ASSERT_EQ(found[i].size(), columns.size()) << file;
    for (std::size_t k = 0; k < columns.size(); ++k) {
      ASSERT_PRED2(same, found[i][k], expected.at(i, columns[k])) << file << " point " << i;
    }
  }
}

TEST_F(ProductClients, Open3dReadsClouds) {
  const ProgramResult import = python({"-c", "import open3d"});
  ASSERT_NE(import.exit_code, 127) << "no " KISSMAP_TEST_PYTHON;
  if (import.exit_code != 0) {
    GTEST_SKIP() << "needs Open3D (package python3-open3d), which could not be loaded: exit code "
                 << import.exit_code << ", " << import.err;
  }
  expect_open3d_reads(product("cloud.pcd"), {"x", "y", "z"});
  export_cloud("packed.pcd", {"--compress"});
  expect_open3d_reads(path("packed.pcd"), {"x", "y", "z"});
  const std::vector<std::string> with_normals{"x", "y", "z", "normal_x", "normal_y", "normal_z"};
  export_cloud("normals.pcd", {"--fields", "normals,time"});
  expect_open3d_reads(path("normals.pcd"), with_normals);
  export_cloud("normals.ply", {"--fields", "normals,time"});
  expect_open3d_reads(path("normals.ply"), {"x", "y", "z", "nx", "ny", "nz"});
  const ProgramResult voxels =
      kissmap({"export-voxels", session(), "-o", path("voxels.ply"), "--resolution", "0.2"});
  ASSERT_EQ(voxels.exit_code, 0) << voxels.err;
  expect_open3d_reads(path("voxels.ply"), {"x", "y", "z"});
}

TEST_F(ProductClients, NetpbmReadsMaps) {
  if (run_program({"pamfile", "--version"}).exit_code != 0) {
    GTEST_SKIP() << "needs netpbm (package netpbm)";
  }
  const std::string file = file_text(product("grid.pgm"));
  const ProgramResult plain = run_program({"pnmtoplainpnm", product("grid.pgm")});
  ASSERT_EQ(plain.exit_code, 0) << plain.err;
  std::istringstream words(plain.out);
  std::string magic;
  std::size_t width = 0;
  std::size_t height = 0;
  int most = 0;
  words >> magic >> width >> height >> most;
  EXPECT_EQ(magic, "P2");
  EXPECT_EQ(most, 255);
  ASSERT_GT(width * height, 1000U);
  ASSERT_GT(file.size(), width * height);
  std::size_t occupied = 0;
  for (std::size_t i = file.size() - width * height; i < file.size(); ++i) {
    int value = -1;
    words >> value;
    ASSERT_EQ(value, static_cast<int>(static_cast<unsigned char>(file[i])));
    ASSERT_TRUE(value == 0 || value == 205 || value == 254) << value;
    occupied += value == 0 ? 1 : 0;
  }
  EXPECT_GT(occupied, 100U);
}

TEST_F(ProductClients, OctomapsToolReadsTheDefaultMap) {
  const ProgramResult result =
      run_program({"convert_octree", product("voxels.bt"), path("voxels.ot")});
  if (result.exit_code == 127) GTEST_SKIP() << "needs convert_octree (package octomap-tools)";
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_THAT(file_text(path("voxels.ot")), testing::StartsWith("# Octomap OcTree file"));
  EXPECT_GT(fs::file_size(path("voxels.ot")), fs::file_size(product("voxels.bt")));
}

}  // namespace
}  // namespace kissmap
