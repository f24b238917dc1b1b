// SPDX-License-Identifier: MIT
// LVX files written byte by byte.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <numbers>

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

std::string header(int minor, float yaw, float x, bool enabled = true) {
  std::string text = "livox_tech" + std::string(6, '\0');
  Bytes bytes;
  bytes.add<std::uint8_t>(1)
      .add<std::uint8_t>(static_cast<std::uint8_t>(minor))
      .add<std::uint16_t>(0);
  bytes.add<std::uint32_t>(0xAC0EA767);
  if (minor > 0) bytes.add<std::uint32_t>(50);
  bytes.add<std::uint8_t>(1);
  bytes.pad(32).add<std::uint8_t>(0).add<std::uint8_t>(7);
  if (minor > 0) bytes.add<std::uint8_t>(enabled ? 1 : 0);
  bytes.add<float>(0).add<float>(0).add<float>(yaw).add<float>(x).add<float>(0).add<float>(0);
  return text + bytes.text();
}

// 96 points of type 2: shot i at (1000 + i, 2000, 3000) mm.
std::string packet(std::int64_t time_ns, std::uint8_t type = 2) {
  Bytes bytes;
  bytes.add<std::uint8_t>(0).pad(4).add<std::uint32_t>(0).add<std::uint8_t>(0).add<std::uint8_t>(
      type);
  bytes.add<std::uint64_t>(static_cast<std::uint64_t>(time_ns));
  for (std::int32_t i = 0; type == 2 && i < 96; ++i) {
    bytes.add<std::int32_t>(1000 + i).add<std::int32_t>(2000).add<std::int32_t>(3000);
    bytes.add<std::uint8_t>(static_cast<std::uint8_t>(i)).add<std::uint8_t>(0);
  }
  if (type == 6) bytes.pad(24);
  return bytes.text();
}

// Ten frames of 50 ms with two packets and one of the inertial sensor.
std::string lvx(int minor, float yaw = 0, float x = 0, bool enabled = true, std::uint8_t type = 2) {
  std::string file = header(minor, yaw, x, enabled);
  for (std::int64_t k = 0; k < 10; ++k) {
    const std::string body = packet(start_ns + k * 50'000'000, type) + packet(start_ns, 6) +
                             packet(start_ns + k * 50'000'000 + 49'000'000, type);
    const std::size_t head = minor == 0 ? 32 : 24;
    Bytes frame;
    frame.add<std::uint64_t>(file.size());
    frame.add<std::uint64_t>(k == 9 ? 0 : file.size() + head + body.size());
    frame.add<std::uint64_t>(static_cast<std::uint64_t>(k));
    if (minor == 0) frame.add<std::uint64_t>(3);
    file += frame.text() + body;
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

TEST(Lvx, CutAnywhereGivesWhatCameBefore) {
  const std::string whole = lvx(1);
  const TempDir dir;
  for (std::size_t percent = 0; percent < 100; ++percent) {
    const fs::path file = dir.write("cut.lvx", whole.substr(0, whole.size() * percent / 100));
    std::vector<LogEntry> entries;
    try {
      entries = read_all(*open_log(file));
    } catch (const Error& error) {
      EXPECT_EQ(error.fault(), Fault::input);
      continue;
    }
    ASSERT_FALSE(entries.empty());
    const bool told = std::holds_alternative<RefusedScan>(entries.back().content);
    // A cut between two frames looks like the end of the file.
    EXPECT_TRUE(told || entries.size() < 6);
    if (told) entries.pop_back();
    for (const LogEntry& entry : entries) EXPECT_EQ(scan_of(entry).points[5].x(), 1.005F);
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
