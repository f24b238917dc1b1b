// SPDX-License-Identifier: MIT
#include "simulator/log_folder.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <cstring>
#include <fstream>
#include <iterator>
#include <sstream>
#include <string>

#include "kissmap/error.hpp"
#include "simulator/scenario.hpp"

namespace kissmap::simulator {
namespace {

namespace fs = std::filesystem;

class LogFolder : public testing::Test {
 protected:
  LogFolder() {
    std::string pattern = (fs::temp_directory_path() / "kissmap-simulator-XXXXXX").string();
    root_ = mkdtemp(pattern.data());
  }
  ~LogFolder() override { fs::remove_all(root_); }

  fs::path write(const char* name, int threads) const {
    const fs::path folder = root_ / name;
    write_log_folder(simulator_, folder, threads, [](std::size_t) {});
    return folder;
  }

  fs::path root_;
  Simulator simulator_ = make_simulator({"town", "spinning16", "car", 1, 5, 60, 1.0});
};

std::string bytes(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

TEST_F(LogFolder, HoldsEveryPointOfEveryScan) {
  const fs::path folder = write("log", 2);
  for (std::size_t i = 0; i < 5; ++i) {
    const std::string ply =
        bytes(folder / "scans" / ("1700000000_" + std::to_string(i) + "00000000.ply"));
    const Scan scan = simulator_.scan(i);
    EXPECT_NE(ply.find("element vertex " + std::to_string(scan.points.size()) + "\n"),
              std::string::npos);
    const std::size_t body = ply.find("end_header\n") + 11;
    ASSERT_EQ(ply.size() - body, 20 * scan.points.size());
    for (std::size_t k = 0; k < scan.points.size(); ++k) {
      float row[5];
      std::memcpy(row, ply.data() + body + 20 * k, sizeof(row));
      EXPECT_EQ(Eigen::Vector3f(row[0], row[1], row[2]), scan.points[k]);
      EXPECT_EQ(row[3], scan.intensities[k]);
      EXPECT_EQ(row[4], scan.time_offsets[k]);
    }
  }
}

TEST_F(LogFolder, TellsTheTruthAtTheEndsOfTheSweeps) {
  std::istringstream truth(bytes(write("log", 1) / "truth.tum"));
  std::string line;
  std::size_t i = 0;
  for (; std::getline(truth, line); ++i) {
    std::istringstream words(line);
    std::string stamp;
    Eigen::Vector3d t;
    Eigen::Vector4d q;
    words >> stamp >> t.x() >> t.y() >> t.z() >> q.x() >> q.y() >> q.z() >> q.w();
    EXPECT_EQ(stamp, "1700000000." + std::to_string(i + 1) + "00000000");
    const Rigid3 expected = simulator_.map_from_lidar(simulator_.stamp_ns(i + 1));
    EXPECT_EQ(t, expected.translation);
    EXPECT_EQ(q, expected.rotation.coeffs());
  }
  EXPECT_EQ(i, 5U);
}

TEST_F(LogFolder, HasTheSameBytesForAnyNumberOfThreads) {
  const fs::path one = write("one", 1);
  const fs::path three = write("three", 3);
  std::size_t files = 0;
  for (const auto& entry : fs::recursive_directory_iterator(one)) {
    if (!entry.is_regular_file()) continue;
    EXPECT_EQ(bytes(entry.path()), bytes(three / fs::relative(entry.path(), one)));
    ++files;
  }
  EXPECT_EQ(files, 6U);
}

TEST_F(LogFolder, TellsWhatPointsLieOnIfAsked) {
  EXPECT_FALSE(fs::exists(write("plain", 1) / "labels"));
  const Simulator office = make_simulator({"office", "spinning16", "robot", 1, 5, 300, 1.0});
  const fs::path folder = root_ / "labelled";
  write_log_folder(
      office, folder, 2, [](std::size_t) {}, true);
  int movers = 0;
  for (std::size_t i = 0; i < 5; ++i) {
    const std::string labels =
        bytes(folder / "labels" / ("1700000000_" + std::to_string(i) + "00000000.u8"));
    const LabelledScan scan = office.labelled_scan(i);
    ASSERT_EQ(labels.size(), scan.scan.points.size());
    for (std::size_t k = 0; k < labels.size(); ++k) {
      ASSERT_EQ(static_cast<ObjectClass>(labels[k]), scan.classes[k]);
      movers += is_moving(scan.classes[k]) ? 1 : 0;
    }
  }
  EXPECT_GT(movers, 0);
  std::istringstream classes(bytes(folder / "labels" / "classes.csv"));
  std::string line;
  std::getline(classes, line);
  EXPECT_EQ(line, "number,name,moving");
  for (int k = 0; k < object_classes; ++k) {
    std::getline(classes, line);
    const auto object_class = static_cast<ObjectClass>(k);
    EXPECT_EQ(
        line,
        std::to_string(k) + "," + name(object_class) + (is_moving(object_class) ? ",1" : ",0"));
  }
  EXPECT_FALSE(std::getline(classes, line));
}

TEST_F(LogFolder, NeitherOverwritesNorLeavesHalves) {
  write("log", 1);
  EXPECT_THROW(write("log", 1), Error);
  std::ofstream(root_ / "file") << "x";
  EXPECT_THROW(write("file/log", 1), Error);
  EXPECT_FALSE(fs::exists(root_ / "log.partial"));
}

}  // namespace
}  // namespace kissmap::simulator
