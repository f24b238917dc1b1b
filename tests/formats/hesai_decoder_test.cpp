// SPDX-License-Identifier: MIT
#include "formats/sensors/hesai_decoder.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <numbers>
#include <random>

#include "formats/clouds/refusal.hpp"
#include "formats/hesai_packets.hpp"
#include "formats/hesai_reference_angles.hpp"
#include "formats/sensor_recording.hpp"

namespace kissmap {
namespace {

using test::HesaiKind;
using test::HesaiPacketBytes;
using test::points_of;
using test::take_all;
using testing::HasSubstr;

constexpr unsigned strongest = 0x37;
constexpr unsigned dual = 0x39;
constexpr unsigned triple = 0x3D;
constexpr std::int64_t second_ns = 1'000'000'000;
constexpr std::int64_t host_ns = 1'700'000'000 * second_ns;

std::vector<Scan> decode(const std::vector<HesaiPacketBytes>& packets,
                         HesaiAngles angles = {},
                         std::int64_t received_ns = host_ns) {
  const auto decoder = make_hesai_decoder(std::move(angles));
  for (const HesaiPacketBytes& packet : packets) decoder->add(packet.bytes(), received_ns);
  decoder->finish();
  EXPECT_EQ(decoder->counts().decoded, packets.size());
  return take_all(*decoder);
}

void expect_near(const Eigen::Vector3f& point, double x, double y, double z) {
  constexpr double tolerance = 6e-5;
  EXPECT_NEAR(point.x(), x, tolerance);
  EXPECT_NEAR(point.y(), y, tolerance);
  EXPECT_NEAR(point.z(), z, tolerance);
}

TEST(HesaiDecoder, PlacesReturnsOfTheXt32AsItsManualSays) {
  HesaiPacketBytes packet(test::xt_32_kind, strongest);
  for (std::size_t block = 0; block < 8; ++block)
    packet.azimuth(block, block < 3 ? 9000 * static_cast<long>(block) : 18000);
  packet.shot(0, 0, 2500, 9);   // laser 1 by 15 degrees up
  packet.shot(1, 15, 2500, 9);  // laser 16 looks level
  packet.shot(2, 31, 2500, 9);  // laser 32 by 16 degrees down
  const Scan scan = decode({packet}).at(0);
  ASSERT_EQ(scan.points.size(), 3U);
  expect_near(scan.points[0], 0.0, 9.65926, 2.58819);
  expect_near(scan.points[1], 10.0, 0.0, 0.0);
  expect_near(scan.points[2], 0.0, -9.61262, -2.75637);
  EXPECT_EQ(scan.intensities[0], 9.0F);
  EXPECT_EQ(scan.stamp_instant, StampInstant::sweep_start);
  EXPECT_EQ(scan.compensation, Compensation::no);
  EXPECT_EQ(scan.time_source, TimeSource::recorded);
}

TEST(HesaiDecoder, AUnitsOwnAnglesCount) {
  HesaiAngles angles(32);
  angles[15] = {30.0, 60.0};
  HesaiPacketBytes packet(test::xt_32_kind, strongest);
  packet.azimuth(0, 3000).shot(0, 15, 2500, 9);
  expect_near(decode({packet}, angles).at(0).points.at(0), 8.66025, 0.0, 5.0);
  EXPECT_THROW(decode({packet}, HesaiAngles(31)), Refusal);
}

struct ShotTime {
  const HesaiKind* kind;
  unsigned mode;
  std::size_t block, laser;
  double us;  ///< after the packet's stamp
};

class HesaiTimes : public testing::TestWithParam<ShotTime> {};

TEST_P(HesaiTimes, FollowFromBlockAndLaser) {
  const ShotTime& c = GetParam();
  HesaiPacketBytes packet(*c.kind, c.mode);
  packet.microseconds(123'456).shot(c.block, c.laser, 1000, 9);
  const Scan scan = decode({packet}).at(0);
  const std::int64_t after_ns = scan.stamp_ns - host_ns - 123'456'000;
  EXPECT_EQ(after_ns, std::llround(c.us * 1000.0));
}

// Blocks and firing orders as in the maker's tables.
INSTANTIATE_TEST_SUITE_P(
    Models,
    HesaiTimes,
    testing::Values(ShotTime{&test::xt_32_kind, strongest, 7, 0, 6.0},
                    ShotTime{&test::xt_32_kind, strongest, 5, 3, -100.0 + 6.0 + 3 * 1.512},
                    ShotTime{&test::xt_32_kind, dual, 5, 3, -50.0 + 6.0 + 3 * 1.512},
                    ShotTime{&test::xt_16_kind, dual, 0, 15, -150.0 + 6.0 + 15 * 3.024},
                    ShotTime{&test::xt_32m_kind, triple, 2, 17, -50.0 + 6.0 + 2.888},
                    ShotTime{&test::qt_128_kind, strongest, 1, 98, 9.0 + 111.11 + 0.6},
                    ShotTime{&test::pandar_64_kind, strongest, 5, 50, -42.58 - 3.62},
                    ShotTime{&test::pandar_64_kind, dual, 1, 11, -42.58 - 2 * 55.56 - 54.668},
                    ShotTime{&test::pandar_40p_kind, strongest, 9, 3, -28.58 - 3.62},
                    ShotTime{&test::pandar_40p_kind, dual, 0, 7, -28.58 - 4 * 55.56 - 54.67}));

// The QT-128 fires in two orders in turns; bit 0 of a byte of its tail tells where it stands.
TEST(HesaiDecoder, TheQt128HasTwoOrdersOfFiring) {
  const auto fired_us = [](unsigned flag, unsigned mode, std::size_t block, std::size_t laser) {
    HesaiPacketBytes packet(test::qt_128_kind, mode);
    packet.put(1061 + 5, flag).shot(block, laser - 1, 1000, 9);
    return static_cast<double>(decode({packet}).at(0).stamp_ns - host_ns) * 1e-3;
  };
  EXPECT_NEAR(fired_us(1, strongest, 0, 99), 9.0 + 0.6, 1e-3);     // first of the first order
  EXPECT_NEAR(fired_us(1, strongest, 1, 65), 120.11 + 0.6, 1e-3);  // first of the second
  EXPECT_NEAR(fired_us(0, strongest, 0, 65), 9.0 + 0.6, 1e-3);
  EXPECT_NEAR(fired_us(1, dual, 0, 61), 9.0 + 100.52, 1e-3);  // last of the first order
  EXPECT_NEAR(fired_us(1, dual, 1, 61), 9.0 + 100.52, 1e-3);
  EXPECT_NEAR(fired_us(2, dual, 1, 31), 9.0 + 100.52, 1e-3);  // last of the second
}

struct Turning {
  const HesaiKind* kind;
  double column_us;
  double block_us;  ///< from the stamp to the column it belongs to
  bool stamp_is_last;
};

class TurningHesai : public testing::TestWithParam<Turning> {};

// The direction of every shot is that of a head that turns evenly, at the shot's time; and turns
// become sweeps.
TEST_P(TurningHesai, DirectionAndTimeAgree) {
  constexpr double deg_per_us = 0.0036;
  constexpr double tolerance_deg = 0.011;  // azimuths come in hundredths of a degree
  const Turning& sensor = GetParam();
  const auto columns = static_cast<int>(sensor.kind->blocks);
  const double packet_us = columns * sensor.column_us;
  const int packets = static_cast<int>(2.5 * 360.0 / deg_per_us / packet_us);
  const auto decoder = make_hesai_decoder(HesaiAngles(sensor.kind->lasers));
  for (int i = 0; i < packets; ++i) {
    HesaiPacketBytes packet(*sensor.kind, strongest);
    packet.all_shots(2500).speed(600).microseconds(
        static_cast<unsigned long>(std::lround(i * packet_us)));
    for (int b = 0; b < columns; ++b) {
      const double us = std::round(i * packet_us) + sensor.block_us +
                        (b - (sensor.stamp_is_last ? columns - 1 : 0)) * sensor.column_us;
      packet.azimuth(static_cast<std::size_t>(b), 36000 + std::lround(us * deg_per_us * 100.0));
    }
    decoder->add(packet.bytes(), host_ns);
  }
  decoder->finish();
  EXPECT_EQ(decoder->sensor(), sensor.kind->sensor);
  const std::vector<Scan> scans = take_all(*decoder);
  ASSERT_EQ(scans.size(), 3U);
  for (const Scan& scan : scans) {
    for (std::size_t i = 0; i < scan.points.size(); ++i) {
      const double us = static_cast<double>(scan.stamp_ns - host_ns) * 1e-3 +
                        static_cast<double>(scan.time_offsets[i]) * 1e6;
      const double deg =
          std::atan2(scan.points[i].x(), scan.points[i].y()) * 180.0 / std::numbers::pi;
      ASSERT_NEAR(std::remainder(deg - us * deg_per_us, 360.0), 0.0, tolerance_deg) << i;
    }
  }
  for (int i = 0; i < 2; ++i)
    EXPECT_NEAR(time_span(scans[static_cast<std::size_t>(i)])->last, 0.1, 2e-4);
}

INSTANTIATE_TEST_SUITE_P(Models,
                         TurningHesai,
                         testing::Values(Turning{&test::xt_32_kind, 50.0, 0.0, true},
                                         Turning{&test::xt_16_kind, 50.0, 0.0, true},
                                         Turning{&test::xt_32m_kind, 50.0, 0.0, true},
                                         Turning{&test::qt_128_kind, 111.11, 9.0, false},
                                         Turning{&test::pandar_64_kind, 55.56, -42.58, true},
                                         Turning{&test::pandar_40p_kind, 55.56, -28.58, true}));

TEST(HesaiDecoder, ReturnsOfOneShotAtOneDistanceCountOnce) {
  HesaiPacketBytes packet(test::xt_32m_kind, triple);
  packet.shot(0, 4, 1000, 10).shot(1, 4, 1000, 20).shot(2, 4, 900, 30);
  packet.shot(3, 4, 800, 40).shot(5, 4, 800, 50);
  const Scan scan = decode({packet}).at(0);
  EXPECT_THAT(scan.intensities, testing::ElementsAre(10, 30, 40));
  EXPECT_EQ(scan.time_offsets[0], scan.time_offsets[1]);
  EXPECT_NEAR(scan.time_offsets[2] - scan.time_offsets[0], 50e-6, 1e-9);
}

TEST(HesaiDecoder, ReadsDatesAndUnixSeconds) {
  const auto stamp_s = [](const HesaiKind& kind, const std::array<unsigned, 6>& date) {
    HesaiPacketBytes packet(kind, strongest);
    const std::size_t last = kind.blocks - 1;
    return decode({packet.date(date).shot(last, 0, 1000, 9)}).at(0).stamp_ns / second_ns;
  };
  EXPECT_EQ(stamp_s(test::xt_32_kind, {0, 0, 0x65, 0x53, 0xF1, 0x00}), 1'700'000'000);
  EXPECT_EQ(stamp_s(test::xt_32_kind, {123, 11, 14, 22, 13, 20}), 1'700'000'000);
  EXPECT_EQ(stamp_s(test::pandar_64_kind, {23, 11, 14, 22, 13, 21}), 1'700'000'000);  // less 65 us
}

TEST(HesaiDecoder, AClockThatWasNeverSetLeavesTheStampToTheHost) {
  HesaiPacketBytes packet(test::xt_32_kind, strongest);
  packet.date({70, 1, 1, 0, 0, 1}).shot(3, 0, 1000, 9).shot(4, 0, 1000, 9);
  const Scan scan = decode({packet}, {}, host_ns + 777).at(0);
  EXPECT_EQ(scan.stamp_ns, host_ns + 777);
  EXPECT_NEAR(scan.time_offsets.at(1), 50e-6, 1e-9);
  packet.date({255, 99, 99, 99, 99, 99});  // no such day
  EXPECT_EQ(decode({packet}, {}, host_ns + 777).at(0).stamp_ns, host_ns + 777);
}

std::string refusal(const HesaiPacketBytes& packet) {
  try {
    make_hesai_decoder()->add(packet.bytes(), host_ns);
  } catch (const Refusal& refused) {
    return refused.what();
  }
  return "nothing was refused";
}

TEST(HesaiDecoder, WhatIsNotSupportedIsRefusedByName) {
  HesaiPacketBytes packet(test::xt_32_kind, strongest);
  EXPECT_THAT(refusal(HesaiPacketBytes(packet).put(2, 1).put(3, 4)), HasSubstr("protocol 1.4"));
  EXPECT_THAT(refusal(HesaiPacketBytes(packet).put(6, 20)), HasSubstr("20 lasers in 8 blocks"));
  EXPECT_THAT(refusal(HesaiPacketBytes(test::xt_32_kind, 0x20)), HasSubstr("return mode"));
  EXPECT_THAT(refusal(HesaiPacketBytes(test::xt_32_kind, triple)), HasSubstr("return mode"));
  HesaiPacketBytes own(test::qt_128_kind, strongest);
  EXPECT_THAT(refusal(own.put(11, 0x5D)), HasSubstr("order of channels"));
}

TEST(HesaiDecoder, OtherTrafficAndDamageAreCounted) {
  const auto decoder = make_hesai_decoder();
  EXPECT_EQ(decoder->sensor(), "Hesai");
  HesaiPacketBytes good(test::xt_32_kind, strongest);
  decoder->add(good.shot(0, 0, 1000, 9).bytes(), host_ns);
  decoder->add(std::vector<std::byte>(512), host_ns);
  decoder->add(HesaiPacketBytes(test::pandar_64_kind, strongest).bytes(), host_ns);
  decoder->add(HesaiPacketBytes(good).put(2, 1).bytes(), host_ns);  // another protocol
  decoder->add(HesaiPacketBytes(test::xt_32_kind, 0x20).bytes(), host_ns);
  decoder->add(HesaiPacketBytes(good).put16(12, 36001).bytes(), host_ns);
  decoder->add(HesaiPacketBytes(good).put(9, 0).bytes(), host_ns);  // no unit
  decoder->finish();
  EXPECT_EQ(decoder->counts().decoded, 1U);
  EXPECT_EQ(decoder->counts().foreign, 3U);
  EXPECT_EQ(decoder->counts().damaged, 3U);
  EXPECT_EQ(points_of(take_all(*decoder)).size(), 1U);
}

const std::vector<const HesaiKind*> kinds{&test::xt_32_kind,
                                          &test::xt_16_kind,
                                          &test::xt_32m_kind,
                                          &test::qt_128_kind,
                                          &test::pandar_64_kind,
                                          &test::pandar_40p_kind};

TEST(HesaiDecoder, NothingBadComesOfAnyLength) {
  for (const HesaiKind* kind : kinds) {
    const auto whole = HesaiPacketBytes(*kind, strongest).all_shots(1000).bytes();
    const auto decoder = make_hesai_decoder();
    std::size_t complete = 0;
    for (std::size_t length = 0; length <= whole.size(); ++length) {
      decoder->add(std::span(whole).first(length), host_ns);
      complete += decoder->counts().decoded > 0 ? 1U : 0U;
    }
    decoder->finish();
    // The Pandars' packets come without a number at the end as well.
    EXPECT_THAT(complete, testing::AnyOf(1U, 5U)) << kind->sensor;
    EXPECT_EQ(points_of(take_all(*decoder)).size() % (kind->blocks * kind->lasers), 0U);
  }
}

TEST(HesaiDecoder, NothingBadComesOfRandomBytes) {
  std::mt19937 random(6);
  for (const HesaiKind* kind : kinds) {
    const auto decoder = make_hesai_decoder();
    for (int i = 0; i < 400; ++i) {
      std::vector<std::byte> bytes(kind->size);
      for (std::byte& byte : bytes) byte = static_cast<std::byte>(random() & 255U);
      HesaiPacketBytes frame(*kind, strongest);
      const auto good = frame.bytes();
      const std::size_t block = kind->before_shots + kind->lasers * kind->shot;
      for (std::size_t b = 0; b < kind->blocks; ++b) {
        const std::size_t at = kind->header + b * block;
        std::copy_n(good.begin() + static_cast<std::ptrdiff_t>(at),
                    kind->before_shots,
                    bytes.begin() + static_cast<std::ptrdiff_t>(at));
        bytes[at + kind->before_shots - 1] = static_cast<std::byte>(random() % 140);
      }
      std::copy_n(good.begin(), kind->header, bytes.begin());
      if (i % 2 == 0) bytes[kind->tail + kind->mode] = std::byte{strongest};
      try {
        decoder->add(bytes, i % 3 == 0 ? static_cast<std::int64_t>(random()) << 31 : host_ns);
      } catch (const Refusal&) {
        EXPECT_EQ(decoder->counts().decoded, 0U);
      }
    }
    decoder->finish();
    EXPECT_GT(decoder->counts().decoded, 150U) << kind->sensor;
    take_all(*decoder);
  }
}

struct Recording {
  const char* folder;
  const HesaiKind* kind;
  HesaiAngles angles;
  double nearest_m;  ///< what the reference leaves out
  double of_turn;    ///< share of the same turn's points that the reference has too
};

class HesaiRecording : public test::PacketRecordings,
                       public testing::WithParamInterface<Recording> {};

// The reference does not turn shots within their block: the motor's speed is taken out of the
// packets to compare all the rest.
TEST_P(HesaiRecording, AgreesWithTheReferenceDecoder) {
  const Recording& recording = GetParam();
  const std::filesystem::path folder = packets_ / "hesai" / recording.folder;
  const auto decoder = make_hesai_decoder(recording.angles);
  for (test::RecordedPacket& packet : test::read_packet_bag(test::only_file(folder, ".db3"))) {
    const std::size_t speed = recording.kind->tail + recording.kind->speed;
    packet.payload.at(speed) = packet.payload.at(speed + 1) = std::byte{0};
    decoder->add(packet.payload, packet.received_ns);
  }
  decoder->finish();
  EXPECT_EQ(decoder->sensor(), recording.kind->sensor);
  EXPECT_EQ(decoder->counts().foreign + decoder->counts().damaged, 0U);
  const std::vector<Scan> scans = take_all(*decoder);
  const auto reference = test::read_reference_cloud(test::only_file(folder, ".pcd"));
  ASSERT_GT(reference.size(), 10'000U);
  constexpr double a_hundredth_of_a_millimetre = 1e-5;
  EXPECT_EQ(test::NearestPoints(points_of(scans), a_hundredth_of_a_millimetre).share(reference),
            1.0);
  std::vector<Eigen::Vector3d> decoded = points_of(scans);
  std::erase_if(decoded, [&](const auto& point) { return point.norm() < recording.nearest_m; });
  const double of_turn = test::best_run(
      test::NearestPoints(reference, a_hundredth_of_a_millimetre), decoded, reference.size());
  RecordProperty("of_turn", std::to_string(of_turn));
  EXPECT_GE(of_turn, recording.of_turn);
}

INSTANTIATE_TEST_SUITE_P(
    Bags,
    HesaiRecording,
    testing::Values(Recording{"xt32", &test::xt_32_kind, test::reference_xt_32, 0.05, 0.98},
                    Recording{"xt16", &test::xt_16_kind, {}, 0.05, 0.98},
                    Recording{"xt32m", &test::xt_32m_kind, test::reference_xt_32m, 0.5, 0.98},
                    Recording{"qt128", &test::qt_128_kind, {}, 0.3, 0.98},
                    Recording{"64", &test::pandar_64_kind, test::reference_pandar_64, 0.3, 0.98},
                    Recording{
                        "40p", &test::pandar_40p_kind, test::reference_pandar_40p, 0.3, 0.98}),
    [](const auto& recording) { return std::string(recording.param.folder); });

}  // namespace
}  // namespace kissmap
