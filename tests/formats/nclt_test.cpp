// SPDX-License-Identifier: MIT
// NCLT, written byte by byte as its owners' tools read it: synchronised clouds and the raw stream.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <span>

#include "formats/dataset_scans.hpp"

namespace kissmap {
namespace {

using test::Bytes;
using test::entries_of;
using test::only_scan;
using test::scan_of;
using test::TempDir;
using testing::HasSubstr;

TEST(Nclt, CoordinatesAreUnsignedAndTurned) {
  const TempDir dir;
  Bytes bytes;
  for (const std::uint16_t raw : std::vector<std::uint16_t>{0, 20000, 32768, 65535}) {
    bytes.add<std::uint16_t>(raw).add<std::uint16_t>(20200).add<std::uint16_t>(20400);
    bytes.add<std::uint8_t>(9).add<std::uint8_t>(31);
  }
  dir.write("velodyne_sync/1357847239000000.bin", bytes.text());
  for (const auto& path : {dir.path(), dir.path() / "velodyne_sync"}) {
    const Scan scan = only_scan(path, "nclt");
    EXPECT_EQ(scan.stamp_ns, 1357847239000000000);
    EXPECT_EQ(scan.compensation, Compensation::yes);
    ASSERT_EQ(scan.points.size(), 4U);
    EXPECT_NEAR(scan.points[0].x(), -100.0F, 1e-4F);
    EXPECT_NEAR(scan.points[1].x(), 0.0F, 1e-4F);
    EXPECT_NEAR(scan.points[2].x(), 63.84F, 1e-4F);
    EXPECT_NEAR(scan.points[3].x(), 227.675F, 1e-4F);
    EXPECT_NEAR(scan.points[3].y(), -1.0F, 1e-4F);
    EXPECT_NEAR(scan.points[3].z(), -2.0F, 1e-4F);
    EXPECT_EQ(scan.intensities[0], 9.0F);
  }
  dir.write("velodyne_sync/1357847239000000.bin", bytes.text() + "x");
  EXPECT_EQ(test::refusal_of(entries_of(dir.path(), "nclt")[0]).reason, "wrong file size");
}

// Packets of 12 directions clockwise, 2 degrees each, on a circle of 10 m. With z down, clockwise
// from above is from x to y.
std::string hits_packet(int number) {
  Bytes bytes;
  for (int i = 0; i < 4; ++i) bytes.add<std::uint16_t>(44444);
  bytes.add<std::uint32_t>(12);
  bytes.add<std::uint64_t>(1'357'847'239'000'000ULL + static_cast<std::uint64_t>(number) * 555);
  bytes.add<std::uint32_t>(0);
  for (int i = 0; i < 12; ++i) {
    const double angle = (number * 2.0 + i * 2.0 / 12) * M_PI / 180.0;
    for (const double metres : {10 * std::cos(angle), 10 * std::sin(angle), 1.0}) {
      bytes.add<std::uint16_t>(static_cast<std::uint16_t>(std::lround((metres + 100.0) / 0.005)));
    }
    bytes.add<std::uint8_t>(static_cast<std::uint8_t>(number % 200)).add<std::uint8_t>(0);
  }
  return bytes.text();
}

std::string hits(int packets) {
  std::string stream;
  for (int i = 0; i < packets; ++i) stream += hits_packet(i);
  return stream;
}

TEST(Nclt, HitsAreCutIntoTurns) {
  const TempDir dir;
  const auto entries = entries_of(dir.write("velodyne_hits.bin", hits(450)), "nclt-hits");
  ASSERT_GE(entries.size(), 2U);
  std::size_t points = 0;
  for (const LogEntry& entry : entries) points += scan_of(entry).points.size();
  EXPECT_EQ(points, 450U * 12);
  const Scan& first = scan_of(entries[0]);
  EXPECT_NEAR(static_cast<double>(first.points.size()), 180 * 12, 24);
  EXPECT_EQ(first.stamp_ns, 1357847239000000000);
  EXPECT_NEAR(first.points[0].x(), 10.0F, 0.01F);
  EXPECT_NEAR(first.points[0].z(), -1.0F, 0.01F);
  EXPECT_NEAR(first.time_offsets[12], 555e-6, 1e-9);
}

TEST(Nclt, HitsGoOnBehindDamage) {
  const TempDir dir;
  std::string stream;
  for (int i = 0; i < 400; ++i) stream += hits_packet(i) + (i == 100 ? "damaged" : "");
  const auto entries =
      entries_of(dir.write("velodyne_hits.bin", stream.substr(0, stream.size() - 5)), "nclt-hits");
  std::size_t points = 0;
  for (std::size_t i = 0; i + 1 < entries.size(); ++i) points += scan_of(entries[i]).points.size();
  EXPECT_EQ(points, 399U * 12);
  EXPECT_THAT(test::refusal_of(entries.back()).detail, HasSubstr("122 bytes"));
}

TEST(CutHits, GiveEveryPacketBefore) {
  constexpr std::size_t packet_bytes = 24 + 12 * 8;
  const TempDir dir;
  const std::string content = hits(450);
  const auto whole = entries_of(dir.write("whole/velodyne_hits.bin", content), "nclt-hits");
  ASSERT_EQ(whole.size(), 3U);  // of 180 packets a turn
  for (std::size_t percent = 1; percent < 100; ++percent) {
    const std::size_t size = content.size() * percent / 100;
    auto entries =
        entries_of(dir.write("cut/velodyne_hits.bin", content.substr(0, size)), "nclt-hits");
    if (size % packet_bytes != 0) {
      EXPECT_THAT(test::refusal_of(entries.back()).detail,
                  HasSubstr(std::to_string(size % packet_bytes) + " bytes"));
      entries.pop_back();
    }
    std::size_t points = 0;
    for (std::size_t i = 0; i < entries.size(); ++i) {
      const Scan& scan = scan_of(entries[i]);
      const Scan& expected = scan_of(whole.at(i));
      EXPECT_EQ(scan.stamp_ns, expected.stamp_ns);
      ASSERT_LE(scan.points.size(), expected.points.size());
      EXPECT_TRUE(
          std::ranges::equal(scan.points, std::span(expected.points).first(scan.points.size())));
      points += scan.points.size();
    }
    EXPECT_EQ(points, size / packet_bytes * 12) << percent;
  }
}

}  // namespace
}  // namespace kissmap
