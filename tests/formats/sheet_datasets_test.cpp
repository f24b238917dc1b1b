// SPDX-License-Identifier: MIT
// Public data sets as generators/*.py write them, which know their layouts from the data sets'
// documentation and nothing of the readers. Points are to be the same float32, unless the reader
// has to turn, raise or scale them.
#include <gtest/gtest.h>

#include "formats/sheet_truth.hpp"

namespace kissmap {
namespace {

struct DataSet {
  const char* generator;
  const char* format;
  std::size_t logs;
  test::Resolution resolution = {};
};

class SheetDataSet : public testing::TestWithParam<DataSet> {};

TEST_P(SheetDataSet, IsReadAsItWasWritten) {
  const auto& [generator, format, logs, resolution] = GetParam();
  const test::Generated written(generator);
  std::size_t found = 0;
  for (const auto& log : written.logs()) {
    if (log.format != format) continue;
    test::expect_log(log, resolution);
    ++found;
  }
  EXPECT_EQ(found, logs);
}

INSTANTIATE_TEST_SUITE_P(
    Public,
    SheetDataSet,
    testing::Values(
        DataSet{"write_kitti.py", "kitti", 1, {.point = 1e-5}},  // raised
        // Stamps are text with nine decimals; azimuths, from the rear, are calculated in float32.
        DataSet{"write_kitti.py", "kitti-raw", 1, {.time = 1e-7}},
        DataSet{"write_mulran.py", "mulran", 1},
        DataSet{"write_helipr.py", "helipr", 4},  // one of each sensor
        DataSet{"write_pcd_sets.py", "apollo", 1},
        DataSet{"write_pcd_sets.py", "newer-college", 1},
        DataSet{"write_nclt.py", "nclt", 1, {.point = 3e-5}},
        DataSet{"write_nclt.py", "nclt-hits", 1, {.point = 3e-5}},
        DataSet{"write_boreas.py", "boreas", 2},      // one of each sensor
        DataSet{"write_nuscenes.py", "nuscenes", 2},  // one of each scene
        // Times are doubles of 1.5e9 s, which are 2.4e-7 s apart.
        DataSet{"write_paris_luco.py", "paris-luco", 1, {.time = 4e-7}}),
    [](const auto& set) {
      std::string name = set.param.format;
      std::erase(name, '-');
      return name;
    });

}  // namespace
}  // namespace kissmap
