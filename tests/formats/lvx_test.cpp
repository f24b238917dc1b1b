// SPDX-License-Identifier: MIT
// LVX files written byte by byte.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <numbers>

#include "formats/lvx_bytes.hpp"
#include "formats/support.hpp"

namespace kissmap {
namespace {

namespace fs = std::filesystem;
using test::Bytes;
using test::error_of;
using test::read_all;
using test::scan_of;
using test::TempDir;
using testing::HasSubstr;

constexpr std::int64_t start_ns = 5'000'000'000;

// 96 points of type 2: shot i at (1000 + i, 2000, 3000) mm.
std::string packet(std::int64_t time_ns, std::uint8_t type = 2) {
  Bytes bytes = test::lvx_packet_head(time_ns, type);
  for (std::int32_t i = 0; type == 2 && i < 96; ++i) {
    bytes.add<std::int32_t>(1000 + i).add<std::int32_t>(2000).add<std::int32_t>(3000);
    bytes.add<std::uint8_t>(static_cast<std::uint8_t>(i)).add<std::uint8_t>(0);
  }
  if (type == 6) bytes.pad(24);
  return bytes.text();
}

// Ten frames of 50 ms with two packets and one of the inertial sensor.
std::string lvx(int minor, float yaw = 0, float x = 0, bool enabled = true, std::uint8_t type = 2) {
  std::string file = test::lvx_header(minor, yaw, x, enabled);
  for (std::int64_t k = 0; k < 10; ++k) {
    const std::string body = packet(start_ns + k * 50'000'000, type) + packet(start_ns, 6) +
                             packet(start_ns + k * 50'000'000 + 49'000'000, type);
    file += test::lvx_frame(minor, file.size(), static_cast<std::uint64_t>(k), body, k == 9);
  }
  return file;
}

TEST(Lvx, OfBothVersionsJoinsFramesToScans) {
  for (const int minor : {0, 1}) {
    const TempDir dir;
    const auto log = open_log(dir.write("log.lvx", lvx(minor)));
    EXPECT_EQ(log->info().format, "lvx");
    const auto entries = read_all(*log);
    std::size_t points = 0;
    for (const LogEntry& entry : entries) points += scan_of(entry).points.size();
    EXPECT_EQ(points, 10U * 2 * 96);
    EXPECT_LE(entries.size(), 5U);
    const Scan& first = scan_of(entries[0]);
    EXPECT_EQ(first.stamp_ns, start_ns);
    EXPECT_EQ(first.points[5], Eigen::Vector3f(1.005F, 2.0F, 3.0F));
    EXPECT_EQ(first.intensities[5], 5.0F);
    EXPECT_NEAR(first.time_offsets[5], 5.0 / 240'000, 1e-9);
    EXPECT_FLOAT_EQ(first.time_offsets[96], 0.049F);
  }
}

TEST(Lvx, MountsOfSensorsAreAppliedWhereTheyAreEnabled) {
  const TempDir dir;
  const auto mounted = read_all(*open_log(dir.write("a.lvx", lvx(1, 90.0F, 10.0F))));
  EXPECT_LT((scan_of(mounted[0]).points[0] - Eigen::Vector3f(8.0F, 1.0F, 3.0F)).norm(), 1e-5F);
  const auto plain = read_all(*open_log(dir.write("b.lvx", lvx(1, 90.0F, 10.0F, false))));
  EXPECT_EQ(scan_of(plain[0]).points[0], Eigen::Vector3f(1.0F, 2.0F, 3.0F));
}

/// Packets of points that lie before the cut as a whole, by how lvx() puts them together.
std::size_t whole_packets(std::size_t cut) {
  const std::size_t points = packet(0).size();
  const std::size_t inertial = packet(0, 6).size();
  std::size_t at = test::lvx_header(1, 0, 0).size();
  std::size_t count = 0;
  for (int frame = 0; frame < 10; ++frame) {
    at += 24;
    if (at + points <= cut) ++count;
    at += points + inertial;
    if (at + points <= cut) ++count;
    at += points;
  }
  return count;
}

TEST(Lvx, CutAnywhereGivesEveryPacketBefore) {
  const std::string whole = lvx(1);
  const TempDir dir;
  for (std::size_t percent = 0; percent < 100; ++percent) {
    const std::size_t size = whole.size() * percent / 100;
    const fs::path file = dir.write("cut.lvx", whole.substr(0, size));
    std::vector<LogEntry> entries;
    try {
      entries = read_all(*open_log(file));
    } catch (const Error& error) {
      EXPECT_EQ(error.fault(), Fault::input);
      EXPECT_THAT(error.what(), HasSubstr("cut.lvx"));
      EXPECT_EQ(whole_packets(size), 0U);
      continue;
    }
    ASSERT_FALSE(entries.empty());
    EXPECT_EQ(test::refusal_of(entries.back()).reason, "truncated file") << percent;
    entries.pop_back();
    std::size_t points = 0;
    for (const LogEntry& entry : entries) {
      for (const Eigen::Vector3f& point : scan_of(entry).points) {
        const auto shot = static_cast<float>(points++ % 96);
        ASSERT_LT((point - Eigen::Vector3f(1.0F + 1e-3F * shot, 2, 3)).norm(), 1e-6F);
      }
    }
    EXPECT_EQ(points, whole_packets(size) * 96) << percent;
  }
}

TEST(Lvx, WhatIsNotReadIsNamed) {
  const TempDir dir;
  EXPECT_THAT(error_of(Fault::input, [&] { open_log(dir.write("a.lvx", lvx(2))); }),
              HasSubstr("LVX 1.2"));
  const auto entries = read_all(*open_log(dir.write("b.lvx", lvx(1, 0, 0, true, 3))));
  ASSERT_EQ(entries.size(), 1U);
  EXPECT_EQ(test::refusal_of(entries[0]).reason, "not supported");
  EXPECT_THAT(test::refusal_of(entries[0]).detail, HasSubstr("data type 3"));
}

}  // namespace
}  // namespace kissmap
