// SPDX-License-Identifier: MIT
#include "formats/sensors/velodyne_decoder.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

#include "formats/clouds/refusal.hpp"
#include "formats/sensor_recording.hpp"
#include "formats/sensors/velodyne_packet.hpp"
#include "formats/sensors/velodyne_tables.hpp"
#include "formats/velodyne_packets.hpp"

namespace kissmap {
namespace {

using test::points_of;
using test::take_all;
using test::VelodynePacket;
using testing::HasSubstr;

constexpr unsigned vlp_16 = 0x22;
constexpr unsigned puck_hi_res = 0x24;
constexpr unsigned hdl_32e = 0x21;
constexpr unsigned vlp_32c = 0x28;
constexpr unsigned vls_128 = 0xA1;
constexpr unsigned strongest = 0x37;
constexpr unsigned last = 0x38;
constexpr unsigned dual = 0x39;
constexpr std::int64_t second_ns = 1'000'000'000;
constexpr std::int64_t host_ns = 1'700'000'000 * second_ns;
constexpr std::uint32_t host_us_past_hour = 800'000'000;  // 1700000000 = 472222 h + 800 s

std::vector<Scan> decode(const std::vector<VelodynePacket>& packets) {
  const auto decoder = make_velodyne_decoder();
  for (const VelodynePacket& packet : packets) decoder->add(packet.bytes(), host_ns);
  decoder->finish();
  EXPECT_EQ(decoder->counts().decoded, packets.size());
  return take_all(*decoder);
}

Eigen::Vector3f only_point(const VelodynePacket& packet) {
  const std::vector<Scan> scans = decode({packet});
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
  const std::vector<Scan> scans = decode({still_packet(0, 0, 5000)});
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
    const std::vector<Scan> scans = decode({packet});
    ASSERT_EQ(scans.at(0).points.size(), 2U);
    EXPECT_NEAR(scans[0].time_offsets.at(1), c.us * 1e-6, 2e-9) << c.product;
  }
}

TEST(VelodyneDecoder, InDualReturnPairsOfBlocksShareTheirTime) {
  VelodynePacket packet(vlp_16, dual, host_us_past_hour);
  packet.shot(4, 2, 1000, 10).shot(5, 2, 900, 20);   // last and strongest differ
  packet.shot(6, 2, 1000, 30).shot(7, 2, 1000, 30);  // are the same
  packet.shot(8, 2, 0, 0).shot(9, 2, 700, 40);       // one only
  const Scan scan = decode({packet}).at(0);
  ASSERT_THAT(scan.intensities, testing::ElementsAre(10, 20, 30, 40));
  EXPECT_EQ(scan.time_offsets[0], scan.time_offsets[1]);
  EXPECT_NEAR(scan.time_offsets[2] - scan.time_offsets[0], 110.592e-6, 2e-9);
  EXPECT_NEAR(scan.time_offsets[3] - scan.time_offsets[2], 110.592e-6, 2e-9);
}

// Columns of one firing or two: their number in a packet, and what is between them.
struct Turning {
  unsigned product = 0;
  unsigned mode = strongest;
  std::size_t columns = 12;
  double column_us = 0.0;
};

VelodynePacket turning_packet(const Turning& sensor, double deg_per_us, double packet_us) {
  VelodynePacket packet(sensor.product,
                        sensor.mode,
                        static_cast<std::uint32_t>(host_us_past_hour + std::llround(packet_us)));
  packet.all_shots(5000);
  const std::size_t per_column = sensor.product == vls_128 && sensor.mode == dual
                                     ? 8
                                     : VelodynePacket::blocks / sensor.columns;
  for (std::size_t block = 0; block < VelodynePacket::blocks; ++block) {
    const double us = packet_us + static_cast<double>(block / per_column) * sensor.column_us;
    packet.azimuth(block, std::lround(us * deg_per_us * 100.0));
    const std::size_t bank = block / (sensor.mode == dual ? 2 : 1) % 4;
    if (sensor.product == vls_128) {
      packet.mark(block, std::array{0xEEFFU, 0xDDFFU, 0xCCFFU, 0xBBFFU}[bank]);
    }
  }
  return packet;
}

class TurningVelodyne : public testing::TestWithParam<Turning> {};

// The direction of every shot is that of a head that turns evenly, at the shot's time.
TEST_P(TurningVelodyne, DirectionAndTimeAgree) {
  constexpr double deg_per_us = 0.0036;    // 600 turns a minute
  constexpr double tolerance_deg = 0.021;  // azimuths come in hundredths of a degree
  const Turning& sensor = GetParam();
  const double packet_us = sensor.column_us * static_cast<double>(sensor.columns);
  std::vector<VelodynePacket> packets;
  for (int i = 0; i < 30; ++i) packets.push_back(turning_packet(sensor, deg_per_us, i * packet_us));
  const Scan scan = decode(packets).at(0);
  const std::span<const VelodyneLaser> lasers =
      find_velodyne_model(static_cast<std::uint8_t>(sensor.product))->lasers;
  const std::size_t first = scan.points.size() / 30;  // rates may need a packet before
  ASSERT_EQ(scan.points.size(), 30 * sensor.columns * std::max<std::size_t>(32, lasers.size()));
  const auto azimuth_deg = [&](std::size_t i) {
    const Eigen::Vector3f& p = scan.points[i];
    const double laser_deg = lasers[i % lasers.size()].turned_deg;
    return std::atan2(-p.y(), p.x()) * 180.0 / std::numbers::pi + laser_deg;
  };
  const double stamp_deg = azimuth_deg(first) - scan.time_offsets[first] * 1e6 * deg_per_us;
  for (std::size_t i = first; i < scan.points.size(); ++i) {
    const double expected = stamp_deg + scan.time_offsets[i] * 1e6 * deg_per_us;
    ASSERT_NEAR(std::remainder(azimuth_deg(i) - expected, 360.0), 0.0, tolerance_deg) << i;
    const double elevation = std::asin(scan.points[i].z() / scan.points[i].norm());
    ASSERT_NEAR(
        elevation * 180.0 / std::numbers::pi, lasers[i % lasers.size()].elevation_deg, 1e-3);
  }
}

INSTANTIATE_TEST_SUITE_P(Models,
                         TurningVelodyne,
                         testing::Values(Turning{vlp_16, strongest, 12, 110.592},
                                         Turning{vlp_16, dual, 6, 110.592},
                                         Turning{puck_hi_res, last, 12, 110.592},
                                         Turning{hdl_32e, strongest, 12, 46.08},
                                         Turning{hdl_32e, dual, 6, 46.08},
                                         Turning{vlp_32c, strongest, 12, 55.296},
                                         Turning{vlp_32c, dual, 6, 55.296},
                                         Turning{vls_128, strongest, 3, 53.3333},
                                         Turning{vls_128, strongest, 3, 57.7778},
                                         Turning{vls_128, dual, 1, 55.0}));

TEST(VelodyneDecoder, ATurnIsASweep) {
  constexpr double deg_per_us = 0.0072;
  const Turning sensor{vlp_16, strongest, 12, 110.592};
  const double packet_us = 12 * 110.592;
  const auto decoder = make_velodyne_decoder();
  constexpr int turns = 4;
  const int packets = static_cast<int>(turns * 360.0 / deg_per_us / packet_us) + 1;
  for (int i = 0; i < packets; ++i) {
    decoder->add(turning_packet(sensor, deg_per_us, i * packet_us).bytes(), host_ns);
  }
  const std::vector<Scan> complete = take_all(*decoder);
  ASSERT_EQ(complete.size(), turns);
  for (std::size_t i = 0; i < complete.size(); ++i) {
    const double columns = 360.0 / deg_per_us / 110.592;
    EXPECT_NEAR(static_cast<double>(complete[i].points.size()), columns * 32.0, 32.0);
    const double begun_s = static_cast<double>(complete[i].stamp_ns - host_ns) * 1e-9;
    EXPECT_NEAR(begun_s, 0.05 * static_cast<double>(i), 111e-6);
    EXPECT_NEAR(time_span(complete[i])->last, 0.05, 111e-6);
  }
}

// Set to a half of the turn, packets hold columns of both ends of that half.
TEST(VelodyneDecoder, TimeGoesOnWhileDirectionsAreSwitchedOff) {
  constexpr double deg_per_us = 0.0036;
  constexpr double column_us = 55.296;
  const auto decoder = make_velodyne_decoder();
  std::vector<double> seen_us;  // times of columns between 0 and 180 degrees
  for (int i = 0; i < 8000; ++i) {
    if (std::fmod(i * column_us * deg_per_us, 360.0) < 180.0) seen_us.push_back(i * column_us);
  }
  for (std::size_t first = 0; first + 12 <= seen_us.size(); first += 12) {
    VelodynePacket packet(
        vlp_32c, strongest, static_cast<std::uint32_t>(host_us_past_hour + seen_us[first]));
    packet.all_shots(2500);
    for (std::size_t b = 0; b < 12; ++b) {
      packet.azimuth(b, std::lround(seen_us[first + b] * deg_per_us * 100.0));
    }
    decoder->add(packet.bytes(), host_ns);
  }
  decoder->finish();
  const std::vector<Scan> scans = take_all(*decoder);
  ASSERT_EQ(scans.size(), 5U);
  for (std::size_t i = 0; i < scans.size(); ++i) {
    for (std::size_t k = 0; k < scans[i].points.size(); k += 32) {
      const double us = static_cast<double>(scans[i].stamp_ns - host_ns) * 1e-3 +
                        static_cast<double>(scans[i].time_offsets[k]) * 1e6;
      const Eigen::Vector3f& p = scans[i].points[k];
      const double deg = std::atan2(-p.y(), p.x()) * 180.0 / std::numbers::pi - 1.4;
      ASSERT_NEAR(std::remainder(deg - us * deg_per_us, 360.0), 0.0, 0.2) << i << " " << k;
    }
  }
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

struct Recording {
  const char* folder;
  const char* sensor;
  double same_direction;  ///< share of points within 0.03 deg of the reference's azimuth
  double most_turned_deg;
};

class VelodyneRecording : public test::PacketRecordings,
                          public testing::WithParamInterface<Recording> {};

// The reference turns shots within blocks by other rules: not at all in the last column of a packet
// (VLP-16, by 0.4 deg), as if the lasers of the VLP-32C fired one by one (0.16 deg), and not at all
// in three of four banks of the VLS-128 (0.19 deg). Distance and elevation of all shots agree.
TEST_P(VelodyneRecording, AgreesWithTheReferenceDecoder) {
  const std::filesystem::path folder = packets_ / "velodyne" / GetParam().folder;
  const auto decoder = make_velodyne_decoder();
  for (const test::RecordedPacket& packet :
       test::read_packet_bag(test::only_file(folder, ".db3"))) {
    decoder->add(packet.payload, packet.received_ns);
  }
  decoder->finish();
  EXPECT_EQ(decoder->sensor(), GetParam().sensor);
  EXPECT_EQ(decoder->counts().foreign + decoder->counts().damaged, 0U);
  const std::vector<Scan> scans = take_all(*decoder);
  test::expect_turns_of_a_tenth(scans);
  const auto reference = test::read_reference_cloud(test::only_file(folder, ".pcd"));
  ASSERT_GT(reference.size(), 10'000U);
  const test::SameShots shots(points_of(scans));
  std::size_t same = 0;
  double most_turned = 0.0;
  for (const Eigen::Vector3d& point : reference) {
    const double turned = shots.turned_deg(point);
    most_turned = std::max(most_turned, turned);
    if (turned < 0.03) ++same;
  }
  const double share = static_cast<double>(same) / static_cast<double>(reference.size());
  RecordProperty("same_direction", std::to_string(share));
  EXPECT_GE(share, GetParam().same_direction);
  EXPECT_LE(most_turned, GetParam().most_turned_deg);
}

/// How far the reference takes a shot to be turned since its block's azimuth, as a share of the
/// step to the next block of the packet. The last block of a packet is not turned at all.
double reference_share(const VelodyneModel& model, std::size_t shot, std::size_t laser) {
  switch (model.pace) {
    case VelodynePace::sixteen_twice:
      return (static_cast<double>(shot % 16) * 2.304 + static_cast<double>(shot / 16) * 55.296) /
             110.592;
    case VelodynePace::eights: {
      const std::size_t group = laser / 8;
      return 2.665 / 53.5 * static_cast<double>(group + group / 8);
    }
    default:
      return 2.304 / 55.296 * static_cast<double>(shot);
  }
}

/// Every return of a packet, turned by the reference's rule.
void append_by_reference(const std::vector<std::byte>& payload, std::vector<Eigen::Vector3d>& to) {
  const PacketBytes packet(payload);
  const VelodyneModel& model = recognize_velodyne(packet);
  const VelodyneBlocks blocks = velodyne_blocks(packet, model);
  for (std::size_t block = 0; block < blocks.count; ++block) {
    const int here = velodyne_azimuth_steps(packet, block);
    const std::size_t next = block + blocks.returns();
    const int step =
        next < blocks.count ? (velodyne_azimuth_steps(packet, next) - here + 36'000) % 36'000 : 0;
    for (std::size_t shot = 0; shot < velodyne_shots_per_block; ++shot) {
      const double range = packet.u16(velodyne_shot_at(block, shot)) * model.unit_m;
      const std::size_t laser =
          (blocks.bank(block) * velodyne_shots_per_block + shot) % model.lasers.size();
      const double radian = std::numbers::pi / 180.0;
      const double turned = here + step * reference_share(model, shot, laser) -
                            100.0 * model.lasers[laser].turned_deg;
      const double azimuth = 0.01 * std::round(turned) * radian;
      const double elevation = model.lasers[laser].elevation_deg * radian;
      to.push_back(range * Eigen::Vector3d(std::cos(elevation) * std::cos(azimuth),
                                           -std::cos(elevation) * std::sin(azimuth),
                                           std::sin(elevation)));
    }
  }
}

// So the directions above are all that differs.
TEST_P(VelodyneRecording, TurnedByItsRuleEveryPointOfTheReferenceIsThere) {
  const std::filesystem::path folder = packets_ / "velodyne" / GetParam().folder;
  std::vector<Eigen::Vector3d> points;
  for (const auto& packet : test::read_packet_bag(test::only_file(folder, ".db3"))) {
    append_by_reference(packet.payload, points);
  }
  const auto reference = test::read_reference_cloud(test::only_file(folder, ".pcd"));
  // Azimuths are rounded to 0.01 deg on either side: a step of that is 4.6 cm at 262 m,
  // the farthest a packet can say.
  EXPECT_GE(test::NearestPoints(points, 0.01).share(reference), 0.997);
  EXPECT_EQ(test::NearestPoints(points, 0.046).share(reference), 1.0);
}

INSTANTIATE_TEST_SUITE_P(Bags,
                         VelodyneRecording,
                         testing::Values(Recording{"vlp16", "Velodyne VLP-16", 0.8, 0.42},
                                         Recording{"vlp32", "Velodyne VLP-32C", 0.2, 0.17},
                                         Recording{"vls128", "Velodyne VLS-128", 0.3, 0.20}),
                         [](const auto& recording) { return std::string(recording.param.folder); });

}  // namespace
}  // namespace kissmap
