// SPDX-License-Identifier: MIT
#include "kissmap/formats/scan_writer.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "formats/support.hpp"

namespace kissmap {
namespace {

using test::error_of;
using test::read_all;
using test::scan_of;
using test::TempDir;
using testing::HasSubstr;

namespace fs = std::filesystem;

Scan scan_number(int k) {
  Scan scan;
  scan.stamp_ns = 1'700'000'000'000'000'000 + std::int64_t{k} * 100'000'001;
  scan.time_source = TimeSource::recorded;
  for (int i = 0; i < 500; ++i) {
    const auto f = static_cast<float>(i);
    scan.points.emplace_back(1.0F + 0.01F * f, static_cast<float>(k) - 0.3F * f, 0.1F * f);
    scan.intensities.push_back(f);
    scan.time_offsets.push_back(-0.05F + 2e-4F * f);
  }
  return scan;
}

std::vector<LogEntry> written(const fs::path& path, ScanFormat format, int scans) {
  const auto writer = open_scan_writer(path, format);
  for (int k = 0; k < scans; ++k) writer->add(scan_number(k));
  writer->finish();
  ReadOptions options;
  options.kitti_elevation_correction = false;
  return read_all(*open_log(path, options));
}

class LosslessFormats : public testing::TestWithParam<ScanFormat> {};

TEST_P(LosslessFormats, GiveBackStampsPointsAndTimes) {
  const TempDir dir;
  const auto entries = written(dir.path() / "out", GetParam(), 30);
  ASSERT_EQ(entries.size(), 30U);
  for (int k = 0; k < 30; ++k) {
    const Scan expected = scan_number(k);
    const Scan& scan = scan_of(entries[static_cast<std::size_t>(k)]);
    EXPECT_EQ(scan.stamp_ns, expected.stamp_ns);
    EXPECT_EQ(scan.points, expected.points);
    EXPECT_EQ(scan.intensities, expected.intensities);
    EXPECT_EQ(scan.time_offsets, expected.time_offsets);
  }
}

INSTANTIATE_TEST_SUITE_P(Formats,
                         LosslessFormats,
                         testing::Values(ScanFormat::pcd, ScanFormat::mcap));

TEST(KittiWriter, GivesBackPointsAndTimeSinceTheFirst) {
  const TempDir dir;
  const auto entries = written(dir.path() / "out", ScanFormat::kitti, 3);
  ASSERT_EQ(entries.size(), 3U);
  EXPECT_EQ(scan_of(entries[2]).points, scan_number(2).points);
  EXPECT_EQ(scan_of(entries[2]).intensities, scan_number(2).intensities);
  EXPECT_EQ(scan_of(entries[2]).stamp_ns, 200'000'002);
}

TEST(ScanWriters, LeaveNothingUnlessFinishedAndOverwriteNothing) {
  const TempDir dir;
  for (const ScanFormat format : {ScanFormat::pcd, ScanFormat::kitti, ScanFormat::mcap}) {
    open_scan_writer(dir.path() / "out", format)->add(scan_number(0));
    EXPECT_TRUE(fs::is_empty(dir.path()));
  }
  dir.write("out", "mine");
  for (const ScanFormat format : {ScanFormat::pcd, ScanFormat::kitti, ScanFormat::mcap}) {
    EXPECT_THAT(error_of(Fault::output, [&] { open_scan_writer(dir.path() / "out", format); }),
                HasSubstr("exists already"));
  }
}

TEST(ScanWriters, WriteTheSameBytesAgain) {
  const TempDir dir;
  written(dir.path() / "a", ScanFormat::mcap, 3);
  written(dir.path() / "b", ScanFormat::mcap, 3);
  std::ifstream a(dir.path() / "a", std::ios::binary);
  std::ifstream b(dir.path() / "b", std::ios::binary);
  const std::string first{std::istreambuf_iterator<char>(a), {}};
  EXPECT_GT(first.size(), 1000U);
  EXPECT_EQ(first, (std::string{std::istreambuf_iterator<char>(b), {}}));
}

}  // namespace
}  // namespace kissmap
