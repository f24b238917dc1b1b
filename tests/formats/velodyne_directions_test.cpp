// SPDX-License-Identifier: MIT
// Directions of Velodyne's shots: those of a head that turns evenly, and of another decoder.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <numbers>
#include <span>

#include "formats/sensors/velodyne_packet.hpp"
#include "formats/sensors/velodyne_tables.hpp"
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
using test::strongest;
using test::take_all;
using test::VelodynePacket;
using test::vlp_16;
using test::vlp_32c;
using test::vls_128;

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
  const Scan scan = decode_velodyne(packets).at(0);
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
