// SPDX-License-Identifier: MIT
#include "kissmap/formats/registry.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <set>

#include "formats/support.hpp"

namespace kissmap {
namespace {

using test::error_of;
using test::TempDir;
using testing::AllOf;
using testing::HasSubstr;

std::string error_at(const std::filesystem::path& path) {
  return error_of(Fault::input, [&] { open_log(path); });
}

TEST(Registry, NamesAreUniqueAndDescribed) {
  std::set<std::string> names;
  for (const LogFormat& format : log_formats()) {
    EXPECT_TRUE(names.insert(format.name).second) << format.name;
    EXPECT_GT(std::string(format.description).size(), 10U);
    EXPECT_GT(std::string(format.layout).size(), 10U);
  }
  EXPECT_GE(names.size(), 3U);
}

TEST(Registry, ListsAllFormatsWhereNoneFits) {
  const TempDir dir;
  const auto lists_all =
      AllOf(HasSubstr("\n  kitti:"), HasSubstr("\n  kitti-raw:"), HasSubstr("\n  folder:"));
  EXPECT_THAT(error_at(dir.path()), AllOf(HasSubstr("an empty folder"), lists_all));
  dir.write("readme.txt", "hello");
  EXPECT_THAT(error_at(dir.path()), AllOf(HasSubstr("not a log kissmap can read"), lists_all));
  EXPECT_THAT(error_at(dir.path() / "readme.txt"), lists_all);
  EXPECT_THAT(error_at(dir.path() / "absent"), HasSubstr("no such file or folder"));
}

TEST(Registry, SaysWhatAForeignFileIs) {
  const TempDir dir;
  EXPECT_THAT(error_at(dir.write("log.dat", "PK\x03\x04")), HasSubstr("log.dat is a zip archive"));
  EXPECT_THAT(error_at(dir.write("log.pkl", "\x1f\x8b")), HasSubstr("is a gzip archive"));
  const TempDir folder;
  folder.write("0.bin", "SQLite format 3");
  EXPECT_THAT(error_at(folder.path()), HasSubstr("0.bin is a SQLite database"));
}

TEST(Registry, DoesNotTakeASessionForALog) {
  const TempDir dir;
  dir.write("session.json", "{}");
  dir.write("local_maps/000000.ply", "ply\n");
  EXPECT_THAT(error_at(dir.path()), HasSubstr("not a log"));
}

TEST(Registry, KnowsTheNamesForFormatOption) {
  const TempDir dir;
  EXPECT_THAT(error_of(Fault::usage, [&] { open_log(dir.path(), {}, "kity"); }),
              AllOf(HasSubstr("'kity'"), HasSubstr("\n  kitti-raw:")));
}

// A KITTI sequence read as a plain folder keeps its points as they are.
TEST(Registry, FormatOptionOverridesTheProbes) {
  const TempDir dir;
  const std::string point =
      test::Bytes().add<float>(10).add<float>(0).add<float>(0).add<float>(0).text();
  dir.write("velodyne/000000.bin", point);
  dir.write("times.txt", "3.5\n");
  EXPECT_EQ(open_log(dir.path())->info().format, "kitti");
  const auto plain = open_log(dir.path(), {}, "folder");
  EXPECT_EQ(plain->info().format, "folder");
  EXPECT_EQ(plain->info().stamp_source, "times.txt");
  const auto entry = plain->next();
  EXPECT_EQ(test::scan_of(*entry).points[0], Eigen::Vector3f(10, 0, 0));
  EXPECT_THAT(error_of(Fault::input, [&] { open_log(dir.path(), {}, "kitti-raw"); }),
              HasSubstr("velodyne_points"));
}

TEST(Registry, ProbesNeverThrow) {
  for (const LogFormat& format : log_formats()) {
    for (const char* path : {"", "/", "/dev/null", "/proc", "/nonexistent/x", "/root/.."}) {
      EXPECT_NO_THROW(format.probe(path)) << format.name << " " << path;
    }
  }
}

TEST(ReadOptionsCheck, NamesTheField) {
  ReadOptions unit;
  unit.time_unit = "minutes";
  EXPECT_THAT(error_of(Fault::usage, [&] { require_valid(unit); }), HasSubstr("time_unit"));
  for (const int columns : {-1, 1, 2, 65}) {
    ReadOptions options;
    options.bin_columns = columns;
    EXPECT_THAT(error_of(Fault::usage, [&] { require_valid(options); }), HasSubstr("bin_columns"));
  }
}

}  // namespace
}  // namespace kissmap
