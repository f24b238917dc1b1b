// SPDX-License-Identifier: MIT
// Files of sensors, bags and captures as generators/*.py write them, and our MCAP files as one of
// them reads them.
#include <gtest/gtest.h>

#include <cmath>

#include "formats/sheet_truth.hpp"
#include "kissmap/formats/scan_writer.hpp"

namespace kissmap {
namespace {

namespace fs = std::filesystem;
using test::expect_log;
using test::Generated;
using test::Resolution;
using test::TempDir;

void expect_all(const Generated& written, std::size_t count, const Resolution& resolution = {}) {
  EXPECT_EQ(written.logs().size(), count);
  for (const auto& log : written.logs()) expect_log(log, resolution);
}

// A packet has one stamp, that of its first shot; the rest follow before the next packet, 10 ms on.
TEST(SheetContainer, LvxOfEveryTypeOfData) {
  const Generated written("write_lvx.py");
  expect_all(written, 8, {.point = 2e-5, .time = 0.01});
  const std::size_t packets = 12;
  for (const auto& log : written.logs()) {
    SCOPED_TRACE(log.path.string());
    const auto& expected = log.scans.at(0);
    if (expected.refused) continue;
    std::vector<std::int64_t> seen;
    for (const auto& entry : test::read_all(*open_log(log.path))) {
      const Scan& scan = test::scan_of(entry);
      for (const float offset : scan.time_offsets) {
        seen.push_back(scan.stamp_ns - expected.stamp_ns +
                       std::llround(static_cast<double>(offset) * 1e9));
      }
    }
    const std::size_t returns = expected.times.size() / packets;
    ASSERT_EQ(seen.size(), returns * packets);
    for (std::size_t i = 0; i < seen.size(); ++i) {
      const auto packet = static_cast<double>(std::llround(expected.times[i] * 1e9));
      EXPECT_GE(static_cast<double>(seen[i]), packet - 20) << i;
      if (i % returns == 0) {
        EXPECT_NEAR(static_cast<double>(seen[i]), packet, 20) << i;
      }
    }
  }
}

TEST(SheetContainer, LivoxMessagesOfBothDrivers) {
  expect_all(Generated("write_livox_bag.py"), 2);
}

TEST(SheetContainer, FoxgloveCloudsAreMovedByTheirPose) {
  expect_all(Generated("write_foxglove_mcap.py"), 4, {.point = 1e-5});
}

TEST(SheetContainer, VelodynePacketsWholeAndInFragments) {
  expect_all(Generated("write_captures.py"), 5, {.point = 1e-5});
}

// The records are those of the data set's generator; what comes back has to be what it knows.
TEST(SheetContainer, McapFilesWeWrite) {
  const Generated written("write_boreas.py");
  const TempDir dir;
  const fs::path file = dir.path() / "out.mcap";
  const auto& log = written.logs().at(0);
  const auto writer = open_scan_writer(file, ScanFormat::mcap);
  for (const auto& entry : test::read_all(*open_log(log.path))) writer->add(test::scan_of(entry));
  writer->finish();
  test::run_generator("read_mcap.py " + file.string() + " " + dir.path().string());
  const auto seen = test::read_truth(dir.path());
  ASSERT_EQ(seen.at(0).scans.size(), log.scans.size());
  for (std::size_t i = 0; i < log.scans.size(); ++i) {
    EXPECT_EQ(seen[0].scans[i].stamp_ns, log.scans[i].stamp_ns);
    test::expect_points(log.scans[i], seen[0].scans[i], {});
  }
}

}  // namespace
}  // namespace kissmap
