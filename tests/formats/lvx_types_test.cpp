// SPDX-License-Identifier: MIT
// Values of the points of each LVX data type, in files written byte by byte.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>

#include "formats/lvx_bytes.hpp"
#include "formats/support.hpp"

namespace kissmap {
namespace {

using test::Bytes;
using test::read_all;
using test::scan_of;
using test::TempDir;

constexpr std::int64_t start_ns = 5'000'000'000;

/// A file of one frame with two packets 1 ms apart, of `shots` shots each.
Scan scan_of_type(std::uint8_t type,
                  std::size_t shots,
                  const std::function<void(Bytes&, std::size_t)>& add_shot) {
  std::string body;
  for (std::int64_t packet = 0; packet < 2; ++packet) {
    Bytes bytes = test::lvx_packet_head(start_ns + packet * 1'000'000, type);
    for (std::size_t i = 0; i < shots; ++i) add_shot(bytes, i);
    body += bytes.text();
  }
  const std::string header = test::lvx_header(1, 0, 0, false);
  const TempDir dir;
  const auto entries = read_all(
      *open_log(dir.write("log.lvx", header + test::lvx_frame(1, header.size(), 0, body, true))));
  EXPECT_EQ(entries.size(), 1U);
  return scan_of(entries.at(0));
}

void add_return(Bytes& bytes, std::int32_t x, std::int32_t y, std::int32_t z, std::uint8_t bright) {
  bytes.add<std::int32_t>(x).add<std::int32_t>(y).add<std::int32_t>(z).add<std::uint8_t>(bright);
}

/// Shot i of either packet has `returns` points; point k of the second packet comes 1 ms later.
void expect_times(const Scan& scan, std::size_t shots, std::size_t returns, double shot_s) {
  ASSERT_EQ(scan.points.size(), 2 * shots * returns);
  ASSERT_EQ(scan.time_offsets.size(), scan.points.size());
  EXPECT_EQ(scan.stamp_ns, start_ns);
  EXPECT_EQ(scan.stamp_instant, StampInstant::sweep_start);
  for (std::size_t i = 0; i < scan.points.size(); ++i) {
    const double packet_s = i < shots * returns ? 0.0 : 1e-3;
    const double expected = packet_s + static_cast<double>(i / returns % shots) * shot_s;
    ASSERT_NEAR(scan.time_offsets[i], expected, 2e-9) << i;
  }
}

constexpr double fast_shot_s = 1.0 / 240'000;

TEST(LvxTypes, ZeroIsCartesianWithoutTag) {
  const Scan scan = scan_of_type(0, 100, [](Bytes& bytes, std::size_t i) {
    add_return(bytes, -1000 - static_cast<int>(i), 2000, 3000, static_cast<std::uint8_t>(i));
  });
  expect_times(scan, 100, 1, 10e-6);
  for (const std::size_t i : {0U, 99U, 100U, 199U}) {
    const auto k = static_cast<float>(i % 100);
    EXPECT_LT((scan.points[i] - Eigen::Vector3f(-1.0F - 1e-3F * k, 2, 3)).norm(), 1e-6F);
    EXPECT_EQ(scan.intensities[i], k);
  }
}

// Distance [mm], angle from the z axis and from the x axis around it, both in 0.01 degrees.
TEST(LvxTypes, OneIsSpherical) {
  const Scan scan = scan_of_type(1, 100, [](Bytes& bytes, std::size_t i) {
    constexpr std::uint16_t zeniths[] = {9000, 9000, 6000, 12'000, 0};
    constexpr std::uint16_t azimuths[] = {0, 9000, 18'000, 33'000, 12'345};
    bytes.add<std::uint32_t>(10'000).add<std::uint16_t>(zeniths[i % 5]);
    bytes.add<std::uint16_t>(azimuths[i % 5]).add<std::uint8_t>(static_cast<std::uint8_t>(i));
  });
  expect_times(scan, 100, 1, 10e-6);
  const std::vector<Eigen::Vector3f> expected{
      {10, 0, 0}, {0, 10, 0}, {-8.660254F, 0, 5}, {7.5F, -4.3301270F, -5}, {0, 0, 10}};
  for (std::size_t i = 0; i < scan.points.size(); ++i) {
    ASSERT_LT((scan.points[i] - expected[i % 5]).norm(), 2e-6F) << i;
    ASSERT_EQ(scan.intensities[i], static_cast<float>(i % 100));
  }
}

TEST(LvxTypes, FourHasTwoReturnsOfAShot) {
  const Scan scan = scan_of_type(4, 48, [](Bytes& bytes, std::size_t i) {
    add_return(bytes, 1000, static_cast<int>(i), 0, 10);
    bytes.add<std::uint8_t>(0xFF);  // tag
    add_return(bytes, 2000, static_cast<int>(i), -500, 20);
    bytes.add<std::uint8_t>(0xFF);
  });
  expect_times(scan, 48, 2, fast_shot_s);
  for (std::size_t i = 0; i < scan.points.size(); ++i) {
    const float y = 1e-3F * static_cast<float>(i / 2 % 48);
    const bool second = i % 2 == 1;
    const Eigen::Vector3f expected(second ? 2.0F : 1.0F, y, second ? -0.5F : 0.0F);
    ASSERT_LT((scan.points[i] - expected).norm(), 1e-6F) << i;
    ASSERT_EQ(scan.intensities[i], second ? 20.0F : 10.0F);
  }
}

TEST(LvxTypes, SevenHasThreeReturnsOfAShot) {
  const Scan scan = scan_of_type(7, 30, [](Bytes& bytes, std::size_t i) {
    for (int k = 1; k <= 3; ++k) {
      add_return(bytes, 1000 * k, static_cast<int>(i), -k, static_cast<std::uint8_t>(50 + k));
      bytes.add<std::uint8_t>(0xFF);
    }
  });
  expect_times(scan, 30, 3, fast_shot_s);
  for (std::size_t i = 0; i < scan.points.size(); ++i) {
    const auto k = static_cast<float>(i % 3 + 1);
    const Eigen::Vector3f expected(k, 1e-3F * static_cast<float>(i / 3 % 30), -1e-3F * k);
    ASSERT_LT((scan.points[i] - expected).norm(), 1e-6F) << i;
    ASSERT_EQ(scan.intensities[i], 50.0F + k);
  }
}

// Of a shot that hit nothing, or hit less often than there is room for, returns are zero.
TEST(LvxTypes, ReturnsThatAreNotThereAreCounted) {
  const Scan scan = scan_of_type(7, 30, [](Bytes& bytes, std::size_t i) {
    for (std::size_t k = 0; k < 3; ++k) {
      add_return(bytes, k < i % 4 ? 1000 : 0, 0, 0, 1);
      bytes.add<std::uint8_t>(0);
    }
  });
  // Of 30 shots seven times 0 + 1 + 2 + 3, and of the last two 0 + 1.
  EXPECT_EQ(scan.points.size(), 2U * (7 * 6 + 1));
  EXPECT_EQ(scan.dropped.zero, 2U * (90 - 43));
  // Shot 0 hit nothing; the sweep began with it all the same.
  EXPECT_EQ(scan.stamp_ns, start_ns);
  EXPECT_NEAR(scan.time_offsets.at(0), fast_shot_s, 2e-9);
}

}  // namespace
}  // namespace kissmap
