// SPDX-License-Identifier: MIT
// Public data sets as generators/*.py write them, which know their layouts from the data sets'
// documentation and nothing of the readers. Points are to be the same float32, unless the reader
// has to turn, raise or scale them.
#include <gtest/gtest.h>

#include "formats/sheet_truth.hpp"

namespace kissmap {
namespace {

using test::expect_log;
using test::Generated;
using test::Resolution;

/// Logs of a format, which have to be as many as `count`.
void expect_logs(const Generated& written,
                 const std::string& format,
                 std::size_t count,
                 const Resolution& resolution = {}) {
  std::size_t found = 0;
  for (const auto& log : written.logs()) {
    if (log.format != format) continue;
    expect_log(log, resolution);
    ++found;
  }
  EXPECT_EQ(found, count);
}

TEST(SheetDataSet, KittiOdometryIsRaised) {
  expect_logs(Generated("write_kitti.py"), "kitti", 1, {.point = 1e-5});
}

TEST(SheetDataSet, KittiRawTurnsFromTheRear) {
  // Its stamps are text with nine decimals; azimuths are calculated in float32.
  expect_logs(Generated("write_kitti.py"), "kitti-raw", 1, {.time = 1e-7});
}

TEST(SheetDataSet, Mulran) {
  expect_logs(Generated("write_mulran.py"), "mulran", 1);
}

TEST(SheetDataSet, HeliprOfFourSensors) {
  expect_logs(Generated("write_helipr.py"), "helipr", 4);
}

TEST(SheetDataSet, Apollo) {
  expect_logs(Generated("write_pcd_sets.py"), "apollo", 1);
}

TEST(SheetDataSet, NewerCollege) {
  expect_logs(Generated("write_pcd_sets.py"), "newer-college", 1);
}

TEST(SheetDataSet, NcltSynchronised) {
  expect_logs(Generated("write_nclt.py"), "nclt", 1, {.point = 3e-5});
}

TEST(SheetDataSet, NcltHits) {
  expect_logs(Generated("write_nclt.py"), "nclt-hits", 1, {.point = 3e-5});
}

TEST(SheetDataSet, BoreasWithBothSensors) {
  expect_logs(Generated("write_boreas.py"), "boreas", 2);
}

TEST(SheetDataSet, NuscenesSceneByScene) {
  expect_logs(Generated("write_nuscenes.py"), "nuscenes", 2);
}

TEST(SheetDataSet, ParisLuco) {
  // Times are doubles of 1.5e9 s, which are 2.4e-7 s apart.
  expect_logs(Generated("write_paris_luco.py"), "paris-luco", 1, {.time = 4e-7});
}

}  // namespace
}  // namespace kissmap
