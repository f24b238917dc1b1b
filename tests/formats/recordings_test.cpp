// SPDX-License-Identifier: MIT
// Real recordings, found by KISSMAP_TEST_DATA; numbers cross-checked with numpy and PCL at run
// time.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <fstream>

#include "formats/support.hpp"

namespace kissmap {
namespace {

namespace fs = std::filesystem;
using test::read_all;
using test::run;
using test::scan_of;
using test::TempDir;

class Recordings : public testing::Test {
 protected:
  void SetUp() override {
    const char* folder = std::getenv("KISSMAP_TEST_DATA");
    if (folder == nullptr) GTEST_SKIP() << "KISSMAP_TEST_DATA does not name the recordings";
    data_ = folder;
  }
  fs::path data_;
};

struct Summary {
  std::string name;
  std::size_t points = 0;
  float x = 0, y = 0, z = 0, intensity = 0;
  double sum = 0.0;
};

// Counts, first point and sum of coordinates of each file, by numpy.
std::vector<Summary> summarize_by_numpy(const fs::path& folder) {
  const TempDir dir;
  const fs::path script = dir.write("summary.py",
                                    "import sys, glob, os, numpy as np\n"
                                    "for f in sorted(glob.glob(sys.argv[1] + '/*.pcd')):\n"
                                    "    b = open(f, 'rb').read()\n"
                                    "    k = b.index(b'DATA binary\\n') + 12\n"
                                    "    a = np.frombuffer(b[k:], '<f4').reshape(-1, 4)\n"
                                    "    a = a[np.any(a[:, :3] != 0, axis=1)]\n"
                                    "    print(os.path.basename(f), len(a), *map(repr, map(float, "
                                    "a[0])), a[:, :3].astype('f8').sum())\n");
  const fs::path output = dir.path() / "summary.txt";
  EXPECT_EQ(std::system((std::string(KISSMAP_TEST_PYTHON) + " " + script.string() + " " +
                         folder.string() + " > " + output.string())
                            .c_str()),
            0);
  std::vector<Summary> result;
  std::ifstream in(output);
  Summary s;
  while (in >> s.name >> s.points >> s.x >> s.y >> s.z >> s.intensity >> s.sum) result.push_back(s);
  return result;
}

void expect_as_numpy_reads(const fs::path& folder, std::size_t scans) {
  const auto log = open_log(folder);
  const auto expected = summarize_by_numpy(folder / "scans");
  ASSERT_EQ(expected.size(), scans);
  ASSERT_EQ(log->info().scan_count, scans);
  for (const Summary& s : expected) {
    const auto entry = log->next();
    const Scan& scan = scan_of(*entry);
    EXPECT_EQ(entry->name, "scans/" + s.name);
    ASSERT_EQ(scan.points.size(), s.points);
    EXPECT_EQ(scan.points[0], Eigen::Vector3f(s.x, s.y, s.z));
    EXPECT_EQ(scan.intensities[0], s.intensity);
    double sum = 0.0;
    for (const auto& p : scan.points) sum += p.cast<double>().sum();
    EXPECT_NEAR(sum, s.sum, 1e-6 * std::abs(s.sum) + 1e-3);
  }
  EXPECT_FALSE(log->next());
}

TEST_F(Recordings, HallOuster) {
  expect_as_numpy_reads(data_ / "hall_ouster", 60);
  const auto log = open_log(data_ / "hall_ouster");
  EXPECT_EQ(log->info().stamp_source, "file names");
  EXPECT_EQ(scan_of(*log->next()).stamp_ns, 1'630'577'758'569'489'956);
}

TEST_F(Recordings, CampusAvia) {
  expect_as_numpy_reads(data_ / "campus_avia_loop", 314);
  const auto log = open_log(data_ / "campus_avia_loop");
  EXPECT_EQ(log->info().stamp_source, "times.txt");
  EXPECT_EQ(scan_of(*log->next()).stamp_ns, 1'577'836'980'099'104'600);
}

TEST_F(Recordings, KittiDrive) {
  expect_as_numpy_reads(data_ / "kitti_drive", 22);
  EXPECT_EQ(open_log(data_ / "kitti_drive")->info().stamp_source, "index");
}

TEST_F(Recordings, CompressedCloudWithAbsoluteTimes) {
  const TempDir dir;
  const fs::path file = data_ / "pointcloud2/top_stationary_timestamped.pcd";
  const fs::path ascii = dir.path() / "ascii.pcd";
  run("pcl_convert_pcd_ascii_binary " + file.string() + " " + ascii.string() + " 0");
  const auto log = open_log(file);
  const auto entry = log->next();
  const Scan& scan = scan_of(*entry);
  EXPECT_EQ(scan.points.size(), 92677U);
  ASSERT_EQ(scan.time_offsets.size(), scan.points.size());
  EXPECT_NEAR(time_span(scan)->last, 0.1, 0.001);
  const auto other_log = open_log(ascii);
  const auto other_entry = other_log->next();
  const Scan& other = scan_of(*other_entry);
  ASSERT_EQ(other.points.size(), scan.points.size());
  for (std::size_t i = 0; i < scan.points.size(); ++i) {
    ASSERT_TRUE(scan.points[i].isApprox(other.points[i], 1e-5F)) << i;
  }
}

TEST_F(Recordings, ReadTheSameAhead) {
  const auto direct = read_all(*open_log(data_ / "kitti_drive"));
  const auto ahead = read_all(*read_ahead(open_log(data_ / "kitti_drive")));
  ASSERT_EQ(ahead.size(), direct.size());
  for (std::size_t i = 0; i < direct.size(); ++i) {
    EXPECT_EQ(scan_of(ahead[i]).points, scan_of(direct[i]).points);
  }
}

}  // namespace
}  // namespace kissmap
