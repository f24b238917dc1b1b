// SPDX-License-Identifier: MIT
// Velodyne's packets: where and when their returns are, and what is refused of them.
#include "formats/sensors/velodyne_decoder.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <random>

#include "formats/clouds/refusal.hpp"
#include "formats/velodyne_scans.hpp"

namespace kissmap {
namespace {

using test::decode_velodyne;
using test::dual;
using test::hdl_32e;
using test::host_ns;
using test::host_us_past_hour;
using test::last;
using test::points_of;
using test::puck_hi_res;
using test::second_ns;
using test::strongest;
using test::take_all;
using test::VelodynePacket;
using test::vlp_16;
using test::vlp_32c;
using test::vls_128;
using testing::HasSubstr;

Eigen::Vector3f only_point(const VelodynePacket& packet) {
  const std::vector<Scan> scans = decode_velodyne({packet});
  EXPECT_EQ(scans.size(), 1U);
  EXPECT_EQ(scans.at(0).points.size(), 1U);
  return scans.at(0).points.at(0);
}

VelodynePacket still_packet(long azimuth, std::size_t shot, unsigned distance) {
  VelodynePacket packet(vlp_16, strongest, host_us_past_hour);
  packet.azimuths(azimuth).shot(0, shot, distance, 9);
  return packet;
}

void expect_near(const Eigen::Vector3f& point, double x, double y, double z) {
  constexpr double tolerance = 6e-5;
  EXPECT_NEAR(point.x(), x, tolerance);
  EXPECT_NEAR(point.y(), y, tolerance);
  EXPECT_NEAR(point.z(), z, tolerance);
}

TEST(VelodyneDecoder, PlacesReturnsOfTheVlp16AsItsManualSays) {
  expect_near(only_point(still_packet(0, 0, 5000)), 9.6593, 0.0, -2.5882);
  expect_near(only_point(still_packet(0, 1, 5010)), 10.0185, 0.0, 0.1749);
  expect_near(only_point(still_packet(9000, 0, 5000)), 0.0, -9.6593, -2.5882);
}

TEST(VelodyneDecoder, ReadsDistancesInTheUnitOfTheModel) {
  for (const unsigned product : {vlp_16, puck_hi_res, hdl_32e}) {
    VelodynePacket packet(product, last, host_us_past_hour);
    EXPECT_NEAR(only_point(packet.shot(2, 3, 65535, 1)).norm(), 131.07, 1e-4);
  }
  VelodynePacket packet(vlp_32c, last, host_us_past_hour);
  EXPECT_NEAR(only_point(packet.shot(2, 3, 65535, 1)).norm(), 262.14, 1e-4);
}

TEST(VelodyneDecoder, TellsTheHourFromTheHost) {
  const std::vector<Scan> scans = decode_velodyne({still_packet(0, 0, 5000)});
  EXPECT_EQ(scans.at(0).stamp_ns, 1'700'000'000 * second_ns);
  EXPECT_EQ(scans.at(0).intensities.at(0), 9.0F);
  EXPECT_EQ(scans.at(0).stamp_instant, StampInstant::sweep_start);
  EXPECT_EQ(scans.at(0).compensation, Compensation::no);
  EXPECT_EQ(scans.at(0).time_source, TimeSource::recorded);
}

TEST(VelodyneDecoder, TheHourNearestToTheHostIsMeant) {
  const auto stamp_at = [](std::int64_t host_s, std::uint32_t us_past_hour) {
    const auto decoder = make_velodyne_decoder();
    VelodynePacket packet(vlp_16, strongest, us_past_hour);
    decoder->add(packet.shot(0, 0, 5000, 1).bytes(), host_s * second_ns);
    decoder->finish();
    return take_all(*decoder).at(0).stamp_ns;
  };
  constexpr std::int64_t on_the_hour_s = 1'700'002'800;
  EXPECT_EQ(stamp_at(on_the_hour_s + 1, 3'599'000'000U), (on_the_hour_s - 1) * second_ns);
  EXPECT_EQ(stamp_at(on_the_hour_s - 1, 1'000'000U), (on_the_hour_s + 1) * second_ns);
}

// A sensor that is out of step by half an hour must not jump with every jitter of the host.
TEST(VelodyneDecoder, StaysWithTheHourItBeganWith) {
  const auto decoder = make_velodyne_decoder();
  constexpr std::int64_t half_hour_s = 1800;
  for (int i = 0; i < 40; ++i) {
    VelodynePacket packet(vlp_16, strongest, host_us_past_hour + 1327U * static_cast<unsigned>(i));
    const std::int64_t jitter_ns = (i % 2 == 0 ? -1 : 1) * 20'000'000;
    decoder->add(packet.azimuths(i * 24).shot(0, 0, 5000, 1).bytes(),
                 host_ns + half_hour_s * second_ns + 1'327'000 * i + jitter_ns);
  }
  decoder->finish();
  EXPECT_EQ(take_all(*decoder).size(), 1U);
}

TEST(VelodyneDecoder, ASweepGoesOnOverTheHour) {
  const auto decoder = make_velodyne_decoder();
  constexpr std::int64_t on_the_hour_ns = 1'700'002'800 * second_ns;
  for (int i = -3; i < 3; ++i) {
    const auto us = static_cast<std::uint32_t>((3'600'000'000 + 1327 * i) % 3'600'000'000);
    VelodynePacket packet(vlp_16, strongest, us);
    packet.azimuths(36'000 + i * 48).shot(0, 0, 5000, 1);
    decoder->add(packet.bytes(), on_the_hour_ns + 1'327'000 * i + 50'000'000);
  }
  decoder->finish();
  const std::vector<Scan> scans = take_all(*decoder);
  ASSERT_EQ(scans.size(), 1U);
  EXPECT_EQ(scans[0].stamp_ns, on_the_hour_ns - 3 * 1'327'000);
  EXPECT_NEAR(scans[0].time_offsets.back(), 5 * 1327e-6, 1e-9);
}

TEST(VelodyneDecoder, TimesFollowFromBlockAndPlace) {
  struct Case {
    unsigned product;
    std::size_t block, shot;
    double us;
  };
  const std::vector<Case> cases{{vlp_16, 3, 20, 3 * 110.592 + 55.296 + 4 * 2.304},
                                {puck_hi_res, 11, 15, 11 * 110.592 + 15 * 2.304},
                                {vlp_32c, 5, 9, 5 * 55.296 + 4 * 2.304},
                                {hdl_32e, 7, 31, 7 * 46.08 + 31 * 1.152}};
  for (const Case& c : cases) {
    VelodynePacket packet(c.product, strongest, host_us_past_hour);
    packet.shot(0, 0, 100, 1).shot(c.block, c.shot, 200, 1);
    const std::vector<Scan> scans = decode_velodyne({packet});
    ASSERT_EQ(scans.at(0).points.size(), 2U);
    EXPECT_NEAR(scans[0].time_offsets.at(1), c.us * 1e-6, 2e-9) << c.product;
  }
}

TEST(VelodyneDecoder, InDualReturnPairsOfBlocksShareTheirTime) {
  VelodynePacket packet(vlp_16, dual, host_us_past_hour);
  packet.shot(4, 2, 1000, 10).shot(5, 2, 900, 20);   // last and strongest differ
  packet.shot(6, 2, 1000, 30).shot(7, 2, 1000, 30);  // are the same
  packet.shot(8, 2, 0, 0).shot(9, 2, 700, 40);       // one only
  const Scan scan = decode_velodyne({packet}).at(0);
  ASSERT_THAT(scan.intensities, testing::ElementsAre(10, 20, 30, 40));
  EXPECT_EQ(scan.time_offsets[0], scan.time_offsets[1]);
  EXPECT_NEAR(scan.time_offsets[2] - scan.time_offsets[0], 110.592e-6, 2e-9);
  EXPECT_NEAR(scan.time_offsets[3] - scan.time_offsets[2], 110.592e-6, 2e-9);
}

TEST(VelodyneDecoder, WhatIsNotSupportedIsRefusedByName) {
  const auto refusal = [](const VelodynePacket& packet) -> std::string {
    try {
      make_velodyne_decoder()->add(packet.bytes(), host_ns);
    } catch (const Refusal& refused) {
      return refused.what();
    }
    return "nothing was refused";
  };
  EXPECT_THAT(refusal(VelodynePacket(0x00, 0, 0).mark(1, 0xDDFF)), HasSubstr("HDL-64E"));
  EXPECT_THAT(refusal(VelodynePacket(0x23, strongest, 0)), HasSubstr("VLP-32A or VLP-32B"));
  EXPECT_THAT(refusal(VelodynePacket(0x31, strongest, 0)), HasSubstr("Velarray"));
  EXPECT_THAT(refusal(VelodynePacket(0x77, strongest, 0)), HasSubstr("product 0x77"));
  EXPECT_THAT(refusal(VelodynePacket(vls_128, 0x3B, 0)), HasSubstr("return mode 0x3B"));
}

TEST(VelodyneDecoder, OtherTrafficAndDamageAreCounted) {
  const auto decoder = make_velodyne_decoder();
  EXPECT_EQ(decoder->sensor(), "Velodyne");
  decoder->add(still_packet(0, 0, 5000).bytes(), host_ns);
  EXPECT_EQ(decoder->sensor(), "Velodyne VLP-16");
  decoder->add(std::vector<std::byte>(512), host_ns);                    // a position packet
  decoder->add(std::vector<std::byte>(1206), host_ns);                   // no mark
  decoder->add(VelodynePacket(vlp_32c, strongest, 0).bytes(), host_ns);  // another sensor
  decoder->add(VelodynePacket(vlp_16, strongest, 0).mark(5, 0x1234).bytes(), host_ns);
  decoder->add(VelodynePacket(vlp_16, strongest, 3'600'000'000U).bytes(), host_ns);
  decoder->add(VelodynePacket(vlp_16, 0x40, 0).bytes(), host_ns);
  decoder->finish();
  EXPECT_EQ(decoder->counts().decoded, 1U);
  EXPECT_EQ(decoder->counts().foreign, 3U);
  EXPECT_EQ(decoder->counts().damaged, 3U);
  EXPECT_EQ(points_of(take_all(*decoder)).size(), 1U);
}

TEST(VelodyneDecoder, NothingBadComesOfAnyLength) {
  const std::vector<std::byte> whole = still_packet(0, 0, 5000).bytes();
  const auto decoder = make_velodyne_decoder();
  for (std::size_t length = 0; length < whole.size(); ++length) {
    const std::vector<std::byte> part(whole.begin(),
                                      whole.begin() + static_cast<std::ptrdiff_t>(length));
    decoder->add(part, host_ns);
  }
  decoder->finish();
  EXPECT_EQ(decoder->counts().foreign, whole.size());
  EXPECT_FALSE(decoder->take());
}

TEST(VelodyneDecoder, NothingBadComesOfRandomBytes) {
  std::mt19937 generator(5);
  const auto random = [&generator] { return static_cast<std::uint32_t>(generator()); };
  for (const unsigned product : {vlp_16, hdl_32e, vlp_32c, vls_128}) {
    const auto decoder = make_velodyne_decoder();
    for (int i = 0; i < 400; ++i) {
      std::vector<std::byte> bytes(1206);
      for (std::byte& byte : bytes) byte = static_cast<std::byte>(random() & 255U);
      const auto frame = VelodynePacket(product, strongest + random() % 3, random()).bytes();
      const bool banks = product == vls_128;
      for (std::size_t b = 0; b < 12; ++b) {
        bytes[b * 100] = std::byte{0xFF};
        bytes[b * 100 + 1] = static_cast<std::byte>(0xEE - 0x11 * (banks ? b % 4 : 0));
        bytes[b * 100 + 3] = static_cast<std::byte>(random() % 140);
      }
      std::copy(frame.begin() + 1200, frame.end(), bytes.begin() + 1200);
      const auto any = static_cast<std::int64_t>((std::uint64_t{random()} << 32) | random());
      decoder->add(bytes, i % 3 == 0 ? any : host_ns);
    }
    decoder->finish();
    EXPECT_GT(decoder->counts().decoded, 50U);
    take_all(*decoder);
  }
}

}  // namespace
}  // namespace kissmap
