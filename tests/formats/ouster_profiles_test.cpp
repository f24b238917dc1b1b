// SPDX-License-Identifier: MIT
// What each profile of Ouster's packets says, by packets made by hand: every bit that is not of the
// field at hand is set, so that a field read one bit too wide or beside its place gives another
// value.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "formats/capture_bytes.hpp"
#include "formats/ouster_packets.hpp"
#include "formats/sensors/ouster_decoder.hpp"
#include "formats/support.hpp"

namespace kissmap {
namespace {

using test::bytes_of;
using test::OusterPacketBytes;
using test::small_ouster;
using test::TempDir;
using testing::ElementsAre;
using testing::IsEmpty;

constexpr std::int64_t start_ns = 1'700'000'000'000'000'000;
constexpr std::int64_t column_ns = 97'000;

using Words = std::vector<std::uint32_t>;

/// Decodes one packet of columns 0 to 15, of which only column 0 has returns: `level` and `aside`
/// are the words of its pixels.
Scan column_of(const std::string& profile, const Words& level, const Words& aside) {
  const auto decoder = make_ouster_decoder(test::ouster_metadata_of(small_ouster(profile)));
  Words both = level;
  both.insert(both.end(), aside.begin(), aside.end());
  OusterPacketBytes packet(profile == "LEGACY", 9);
  packet.column(start_ns, 0, both);
  for (std::size_t c = 1; c < 16; ++c) {
    packet.column(start_ns + static_cast<std::int64_t>(c) * column_ns, c, Words(both.size(), 0));
  }
  decoder->add(bytes_of(packet.text()), start_ns);
  EXPECT_EQ(decoder->counts().decoded, 1U) << profile;
  decoder->finish();
  auto scan = decoder->take();
  if (!scan) return {};
  require_consistent(*scan);
  EXPECT_FALSE(decoder->take());
  return *scan;
}

/// Where the manual's formula puts returns of column 0: the frame of the lidar is turned by 180
/// degrees, and the beams begin 10 mm in front of the axis.
Eigen::Vector3d level_at(double range_mm) {
  return {-1e-3 * range_mm, 0.0, 0.03618};
}
Eigen::Vector3d aside_at(double range_mm) {
  const double r = range_mm - 10.0;
  return 1e-3 * Eigen::Vector3d(-10.0, r * std::sqrt(0.75), r / 2 + 36.18);
}

void expect_points(const Scan& scan, const std::vector<Eigen::Vector3d>& expected) {
  ASSERT_EQ(scan.points.size(), expected.size());
  for (std::size_t i = 0; i < expected.size(); ++i) {
    EXPECT_LT((scan.points[i].cast<double>() - expected[i]).norm(), 1e-6 * expected[i].norm()) << i;
    EXPECT_EQ(scan.time_offsets[i], 0.0F);
  }
}

TEST(OusterProfiles, Legacy) {
  // Range 0:20, others to 32; reflectivity 8 bits; signal in the upper half of the second word.
  const Scan scan = column_of("LEGACY",
                              {0xFFF00000U | 5000, 0x012CFFFFU, 0xFFFFFFFFU},
                              {0xFFF00000U | 0x80001, 0x00C8FFFFU, 0xFFFFFFFFU});
  expect_points(scan, {level_at(5000), aside_at(524'289)});
  EXPECT_THAT(scan.intensities, ElementsAre(300.0F, 200.0F));
}

TEST(OusterProfiles, Single) {
  for (const char* name : {"RNG19_RFL8_SIG16_NIR16", "RNG19_RFL8_SIG16_NIR16_SINGLE"}) {
    const Scan scan = column_of(name,
                                {0xFFF80000U | 5000, 0x012CFFFFU, 0xFFFFFFFFU},
                                {0xFFF80000U | 0x40001, 0x00C8FFFFU, 0xFFFFFFFFU});
    expect_points(scan, {level_at(5000), aside_at(262'145)});
    EXPECT_THAT(scan.intensities, ElementsAre(300.0F, 200.0F));
  }
}

// Two words with a range each, both signals in the third, near infrared in the fourth.
void expect_dual(const std::string& profile, const Words& after) {
  const auto pixel = [&](std::uint32_t first, std::uint32_t second) {
    Words words{0xFFF80000U | first, 0xFFF80000U | second, 0x012C'0190U, 0xFFFFFFFFU};
    words.insert(words.end(), after.begin(), after.end());
    return words;
  };
  const Scan scan = column_of(profile, pixel(5000, 9000), pixel(0x40001, 7000));
  expect_points(scan, {level_at(5000), level_at(9000), aside_at(262'145), aside_at(7000)});
  EXPECT_THAT(scan.intensities, ElementsAre(400.0F, 300.0F, 400.0F, 300.0F));
  // One return only, whichever place it stands in, and two at one distance.
  const Scan one = column_of(profile, pixel(5000, 0), pixel(0, 7000));
  expect_points(one, {level_at(5000), aside_at(7000)});
  EXPECT_THAT(one.intensities, ElementsAre(400.0F, 300.0F));
  expect_points(column_of(profile, pixel(5000, 5000), pixel(0, 0)), {level_at(5000)});
  EXPECT_THAT(column_of(profile, pixel(0, 0), pixel(0, 0)).points, IsEmpty());
}

TEST(OusterProfiles, Dual) {
  expect_dual("RNG19_RFL8_SIG16_NIR16_DUAL", {});
}

TEST(OusterProfiles, FiveWords) {
  expect_dual("FIVE_WORD_PIXEL", {0xFFFFFFFFU});
}

// Range 0:15 in steps of 8 mm, a flag, reflectivity 16:8, near infrared 24:8.
TEST(OusterProfiles, LowBandwidth) {
  const Scan scan = column_of("RNG15_RFL8_NIR8", {0xFF2A8000U | 625}, {0xFF078000U | 0x4001});
  expect_points(scan, {level_at(5000), aside_at(131'080)});
  EXPECT_THAT(scan.intensities, ElementsAre(42.0F, 7.0F));
}

TEST(OusterProfiles, LowBandwidthDual) {
  const Scan scan = column_of("RNG15_RFL8_NIR8_DUAL",
                              {0xFF2A8000U | 625, 0xFF078000U | 1125},
                              {0xFF2A8000U | 0x4001, 0xFF078000U | 1000});
  expect_points(scan, {level_at(5000), level_at(9000), aside_at(131'080), aside_at(8000)});
  EXPECT_THAT(scan.intensities, ElementsAre(42.0F, 7.0F, 42.0F, 7.0F));
  const Scan one =
      column_of("RNG15_RFL8_NIR8_DUAL", {0xFF2A8000U | 625, 0xFF078000U}, {0, 0xFF070000U | 1000});
  expect_points(one, {level_at(5000), aside_at(8000)});
  EXPECT_THAT(one.intensities, ElementsAre(42.0F, 7.0F));
}

/// A capture of frames of which the sensor sends columns 100 to 199 only: packets that hold any of
/// them, whose other columns are marked as not valid though they hold a range.
std::string windowed_capture(int frames) {
  std::vector<std::string> packets;
  for (int frame = 0; frame < frames; ++frame) {
    for (std::size_t first = 96; first < 200; first += 16) {
      OusterPacketBytes packet(false, static_cast<std::uint16_t>(frame));
      for (std::size_t c = first; c < first + 16; ++c) {
        const std::int64_t time_ns =
            start_ns + frame * 100'000'000LL + static_cast<std::int64_t>(c) * column_ns;
        const auto signal = static_cast<std::uint32_t>(c) << 16U;
        const bool sent = c >= 100 && c < 200;
        packet.column(time_ns, c, {5000, signal, 0, 0, 0, 0}, sent);
      }
      packets.push_back(test::ethernet(test::ipv4(test::udp(7502, packet.text()))));
    }
  }
  return test::pcap(packets);
}

TEST(OusterWindow, GivesItsColumnsWithTheirDirectionsAndTimes) {
  auto metadata = small_ouster("RNG19_RFL8_SIG16_NIR16");
  metadata["data_format"]["column_window"] = {100, 199};
  const TempDir dir;
  dir.write("log.json", metadata.dump());
  const auto log = open_log(dir.write("log.pcap", windowed_capture(3)));
  for (int frame = 0; frame < 3; ++frame) {
    const auto entry = log->next();
    ASSERT_TRUE(entry);
    const Scan& scan = test::scan_of(*entry);
    ASSERT_EQ(scan.points.size(), 100U);  // only the level beam has returns
    // The stamp is the first column's that was sent.
    EXPECT_EQ(scan.stamp_ns, start_ns + frame * 100'000'000LL + 100 * column_ns);
    for (std::size_t i = 0; i < 100; ++i) {
      // The encoder turns clockwise from -x of the sensor, 1024 columns a turn.
      const double turned = 2 * M_PI * static_cast<double>(100 + i) / 1024;
      const Eigen::Vector3d expected(-5.0 * std::cos(turned), 5.0 * std::sin(turned), 0.03618);
      ASSERT_LT((scan.points[i].cast<double>() - expected).norm(), 1e-5) << i;
      ASSERT_EQ(scan.intensities[i], static_cast<float>(100 + i));
      ASSERT_NEAR(scan.time_offsets[i], static_cast<double>(i) * 97e-6, 1e-9);
    }
  }
  EXPECT_FALSE(log->next());
}

}  // namespace
}  // namespace kissmap
