// SPDX-License-Identifier: MIT
// Files written by other programs: numpy (write_clouds.py) and PCL's tools.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <sstream>

#include "formats/support.hpp"

namespace kissmap {
namespace {

namespace fs = std::filesystem;
using test::read_all;
using test::run;
using test::scan_of;
using test::TempDir;

constexpr std::size_t point_count = 1000;

struct Case {
  std::string name;
  fs::path path;
  std::string start;
  double tolerance = 0.0;
};

std::vector<Case> read_cases(const fs::path& file) {
  std::vector<Case> cases;
  std::ifstream in(file);
  Case next;
  while (in >> next.name >> next.path >> next.start >> next.tolerance) cases.push_back(next);
  return cases;
}

// The closed form in write_clouds.py.
void expect_points(const Scan& scan) {
  ASSERT_EQ(scan.points.size(), point_count);
  ASSERT_EQ(scan.intensities.size(), point_count);
  for (std::size_t i = 0; i < point_count; ++i) {
    const auto k = static_cast<float>(i);
    ASSERT_EQ(scan.points[i], Eigen::Vector3f(1 + k / 2, -2 - k / 4, k / 8)) << i;
    ASSERT_EQ(scan.intensities[i], static_cast<float>(i % 200)) << i;
  }
}

void expect_times(const Scan& scan, double start, double tolerance) {
  ASSERT_EQ(scan.time_offsets.size(), point_count);
  for (std::size_t i = 0; i < point_count; ++i) {
    ASSERT_NEAR(scan.time_offsets[i], start + static_cast<double>(i) * 1e-4, tolerance) << i;
  }
}

TEST(NumpyWrites, EveryEncodingOrderPaddingAndTime) {
  const TempDir dir;
  run(std::string(KISSMAP_TEST_PYTHON) + " " KISSMAP_TEST_SOURCES "/write_clouds.py " +
      dir.path().string());
  const std::vector<Case> cases = read_cases(dir.path() / "cases.txt");
  EXPECT_EQ(cases.size(), 11U * 3 * 2 * 6 + 2);
  for (const Case& c : cases) {
    SCOPED_TRACE(c.name);
    ReadOptions options;
    if (c.name == "bin_4") options.bin_columns = 4;  // 16000 bytes fit rows of 5, too
    if (c.name == "bin_6") options.bin_columns = 6;
    const auto entries = read_all(*open_log(c.path, options));
    const Scan& scan = scan_of(entries[0]);
    EXPECT_EQ(scan.stamp_ns, 1'600'000'000'250'000'000);
    expect_points(scan);
    if (c.start == "none") {
      EXPECT_EQ(scan.time_source, TimeSource::none);
    } else {
      expect_times(scan, std::stod(c.start), c.tolerance);
    }
  }
}

/// A small cloud in the form PCL reads from text: with a NaN, a ring and a time.
fs::path write_ascii(const TempDir& dir, int count) {
  std::ostringstream text;
  text << "# .PCD v0.7 - Point Cloud Data file format\nVERSION 0.7\n"
          "FIELDS x y z intensity t ring\nSIZE 4 4 4 4 4 2\nTYPE F F F F U U\nCOUNT 1 1 1 1 1 1\n"
          "WIDTH "
       << count << "\nHEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS " << count << "\nDATA ascii\n";
  for (int i = 0; i < count; ++i) {
    if (i == 1) {
      text << "nan nan nan 0 0 0\n";
    } else {
      text << 0.1 * i << " " << -0.001 * i << " " << 1.5 + i / 8 << " " << i % 256 << " "
           << 1000 * i << " " << i % 64 << "\n";
    }
  }
  return dir.write("ascii.pcd", text.str());
}

void expect_same(const Scan& scan, const Scan& expected) {
  EXPECT_EQ(scan.points, expected.points);
  EXPECT_EQ(scan.intensities, expected.intensities);
  EXPECT_EQ(scan.time_offsets, expected.time_offsets);
  EXPECT_EQ(scan.dropped, expected.dropped);
}

Scan read_one(const fs::path& path) {
  const auto log = open_log(path);
  const auto entry = log->next();
  return scan_of(*entry);
}

TEST(PclConverts, PcdBetweenItsEncodings) {
  const TempDir dir;
  for (const int count : {4, 100, 20'000}) {
    const fs::path ascii = write_ascii(dir, count);
    const Scan expected = read_one(ascii);
    ASSERT_EQ(expected.points.size(), static_cast<std::size_t>(count - 1));
    EXPECT_NEAR(expected.time_offsets.back(), (count - 1) * 1e-6, 1e-8);
    for (const int encoding : {0, 1, 2}) {
      const fs::path converted = dir.path() / ("pcl" + std::to_string(encoding) + ".pcd");
      run("pcl_convert_pcd_ascii_binary " + ascii.string() + " " + converted.string() + " " +
          std::to_string(encoding));
      SCOPED_TRACE(std::to_string(count) + " points, encoding " + std::to_string(encoding));
      expect_same(read_one(converted), expected);
    }
  }
}

TEST(PclConverts, PcdToPly) {
  const TempDir dir;
  const fs::path ascii = write_ascii(dir, 100);
  const Scan expected = read_one(ascii);
  for (const char* format : {"0", "1"}) {
    const fs::path converted = dir.path() / "pcl.ply";
    run("pcl_pcd2ply -format " + std::string(format) + " " + ascii.string() + " " +
        converted.string());
    const Scan scan = read_one(converted);
    SCOPED_TRACE(format);
    ASSERT_EQ(scan.points.size(), expected.points.size());
    for (std::size_t i = 0; i < scan.points.size(); ++i) {
      EXPECT_TRUE(scan.points[i].isApprox(expected.points[i], 1e-5F)) << i;
    }
    EXPECT_EQ(scan.intensities, expected.intensities);
    EXPECT_EQ(scan.time_offsets, expected.time_offsets);
  }
}

}  // namespace
}  // namespace kissmap
