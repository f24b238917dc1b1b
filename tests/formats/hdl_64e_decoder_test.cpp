// SPDX-License-Identifier: MIT
// Packets of a synthetic HDL-64E: there is no public recording of one with its calibration.
#include "formats/sensors/hdl_64e_decoder.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <numbers>
#include <random>

#include "formats/clouds/refusal.hpp"
#include "formats/hdl_64e_unit.hpp"
#include "formats/sensor_recording.hpp"
#include "formats/sensors/velodyne_decoder.hpp"
#include "formats/support.hpp"
#include "formats/velodyne_packets.hpp"

namespace kissmap {
namespace {

using test::error_of;
using test::hdl_64e_packet;
using test::points_of;
using test::random_calibration;
using test::take_all;
using test::VelodynePacket;
using test::yaml_of;
using testing::HasSubstr;

constexpr double pi = std::numbers::pi;
constexpr std::int64_t second_ns = 1'000'000'000;
constexpr std::int64_t host_ns = 1'700'000'000 * second_ns;  // 472222 h + 800 s
constexpr std::uint32_t past_hour_us = 800'000'000;

std::vector<Scan> decode(const Hdl64eCalibration& calibration,
                         const std::vector<VelodynePacket>& packets,
                         std::int64_t between_ns = 288'000) {
  const auto decoder = make_hdl_64e_decoder(calibration);
  std::int64_t received_ns = host_ns;
  for (const VelodynePacket& one : packets) {
    decoder->add(one.bytes(), received_ns);
    received_ns += between_ns;
  }
  decoder->finish();
  EXPECT_EQ(decoder->counts().decoded, packets.size());
  return take_all(*decoder);
}

Eigen::Vector3d only_point(const Hdl64eCalibration& calibration, const VelodynePacket& one) {
  const auto points = points_of(decode(calibration, {one}));
  EXPECT_EQ(points.size(), 1U);
  return points.at(0);
}

TEST(Hdl64eDecoder, PlacesReturnsByTheAnglesOfTheLaser) {
  Hdl64eCalibration calibration;
  calibration[0].elevation = -15.0 * pi / 180.0;
  calibration[32].rotation = 10.0 * pi / 180.0;
  const Eigen::Vector3d below =
      only_point(calibration, hdl_64e_packet(past_hour_us, 0, 17).shot(0, 0, 5000, 9));
  EXPECT_NEAR((below - Eigen::Vector3d(9.6593, 0.0, -2.5882)).norm(), 0.0, 1e-4);
  const Eigen::Vector3d right =
      only_point(calibration, hdl_64e_packet(past_hour_us, 10000, 17).shot(1, 0, 5000, 9));
  EXPECT_NEAR((right - Eigen::Vector3d(0.0, -10.0, 0.0)).norm(), 0.0, 1e-4);
}

TEST(Hdl64eDecoder, DistancesAreCorrectedAsMeasuredAtBothWalls) {
  // At the walls where the maker measured, the correction is the one found there.
  Hdl64eCalibration calibration;
  calibration[0].distance = 1.0;
  calibration[0].two_points = true;
  calibration[0].distance_at_x = 1.2;
  calibration[0].distance_at_y = 0.7;
  const auto corrected = [&](long steps, unsigned raw) {
    return only_point(calibration, hdl_64e_packet(past_hour_us, steps, 17).shot(0, 0, raw, 9));
  };
  EXPECT_NEAR(corrected(9000, 700).y(), -(1.4 + 1.2), 1e-4);      // 2.40 m to the right
  EXPECT_NEAR(corrected(9000, 12020).y(), -(24.04 + 1.0), 1e-4);  // 25.04 m
  EXPECT_NEAR(corrected(0, 465).x(), 0.93 + 0.7, 1e-4);           // 1.93 m ahead
  EXPECT_NEAR(corrected(0, 12020).x(), 24.04 + 1.0, 1e-4);
}

TEST(Hdl64eDecoder, OffsetsMoveTheRaySideways) {
  Hdl64eCalibration calibration;
  calibration[5].horizontal_offset = 0.026;
  calibration[5].vertical_offset = 0.2;
  const Eigen::Vector3d ahead =
      only_point(calibration, hdl_64e_packet(past_hour_us, 0, 0).shot(0, 5, 5000, 9));
  // 2.6 cm to the left of a ray straight ahead, 20 cm above.
  EXPECT_NEAR((ahead - Eigen::Vector3d(10.0, 0.026, 0.2)).norm(), 0.0, 1e-4);
  calibration[5].elevation = 0.5;
  const Eigen::Vector3d up =
      only_point(calibration, hdl_64e_packet(past_hour_us, 0, 0).shot(0, 5, 5000, 9));
  const Eigen::Vector3d along(std::cos(0.5), 0.0, std::sin(0.5));
  const Eigen::Vector3d across(-std::sin(0.5), 0.0, std::cos(0.5));
  EXPECT_NEAR((up - 10.0 * along - 0.2 * across - Eigen::Vector3d(0, 0.026, 0)).norm(), 0.0, 1e-4);
}

struct PaceCase {
  const char* name;
  std::uint32_t packet_us;
  double column_us;
  double four_us;
};
class Hdl64ePace : public testing::TestWithParam<PaceCase> {};

TEST_P(Hdl64ePace, IsToldByThePacketsThemselves) {
  const auto& [name, packet_us, column_us, four_us] = GetParam();
  constexpr long steps_a_column = 18;
  std::vector<VelodynePacket> packets;
  for (std::uint32_t i = 0; i < 4; ++i) {
    packets.push_back(hdl_64e_packet(
        past_hour_us + i * packet_us + i / 2, i * 6 * steps_a_column, steps_a_column));
  }
  packets[0].shot(0, 0, 5000, 1).shot(11, 31, 5000, 1);
  packets[3].shot(5, 4, 5000, 1);
  const std::vector<Scan> scans = decode({}, packets);
  ASSERT_EQ(scans.size(), 1U);
  ASSERT_EQ(scans[0].points.size(), 3U);
  EXPECT_EQ(scans[0].stamp_ns, host_ns);
  const double last_us = 5 * column_us + 7 * four_us;
  EXPECT_NEAR(scans[0].time_offsets[1] * 1e6, last_us + 3.68, 0.05);
  EXPECT_NEAR(scans[0].time_offsets[2] * 1e6, 3 * packet_us + 1 + 2 * column_us + four_us, 0.05);
  // The turn goes on between the lasers.
  const double turned = std::atan2(-scans[0].points[1].y(), scans[0].points[1].x());
  const double expected =
      (5 + (7 * four_us + 3.68) / column_us) * steps_a_column * 0.01 * pi / 180.0;
  EXPECT_NEAR(turned, expected, 1e-5);
}
INSTANTIATE_TEST_SUITE_P(Models,
                         Hdl64ePace,
                         testing::Values(PaceCase{"S2", 288, 48.0, 6.0},
                                         PaceCase{"S3", 345, 57.6, 7.2}),
                         [](const auto& one) { return std::string(one.param.name); });

TEST(Hdl64eDecoder, AnS1IsDatedByTheReceiver) {
  std::vector<VelodynePacket> packets;
  for (std::uint32_t i = 0; i < 40; ++i) {
    packets.push_back(hdl_64e_packet(0x12345678 * i, static_cast<long>(i), 0).shot(0, 0, 5000, 1));
  }
  const std::vector<Scan> scans = decode({}, packets, 384'600);
  ASSERT_EQ(scans.size(), 1U);
  EXPECT_EQ(scans[0].stamp_ns, host_ns);
  EXPECT_NEAR(scans[0].time_offsets.back(), 39 * 384.6e-6, 1e-7);
}

TEST(Hdl64eDecoder, TwoReturnsShareTheirTime) {
  std::vector<VelodynePacket> packets;
  for (std::uint32_t i = 0; i < 2; ++i) {
    packets.push_back(hdl_64e_packet(past_hour_us + 144 * i, 60 * static_cast<long>(i), 20, 4));
  }
  packets[1].shot(0, 3, 5000, 1).shot(2, 3, 6000, 1);  // two distances
  packets[1].shot(4, 3, 5000, 1).shot(6, 3, 5000, 1);  // the same twice
  packets[1].shot(9, 3, 5000, 1);                      // the lower bank
  const std::vector<Scan> scans = decode({}, packets);
  ASSERT_EQ(scans.size(), 1U);
  ASSERT_EQ(scans[0].points.size(), 4U);
  EXPECT_EQ(scans[0].time_offsets[0], scans[0].time_offsets[1]);
  EXPECT_NEAR(scans[0].time_offsets[2] * 1e6, 48.0, 0.01);
  EXPECT_NEAR(scans[0].time_offsets[3] * 1e6, 96.0, 0.01);
}

TEST(Hdl64eDecoder, IntensityStaysWithinTheLimits) {
  Hdl64eCalibration calibration;
  calibration[0].focal_slope = 1.5;
  calibration[0].focal_distance = 13'100.0;  // the focal term is zero
  calibration[0].most_intensity = 200.0;
  VelodynePacket one = hdl_64e_packet(past_hour_us, 0, 17);
  one.shot(0, 0, 32768, 10).shot(2, 0, 32768, 250);
  const std::vector<Scan> scans = decode(calibration, {one});
  EXPECT_NEAR(scans.at(0).intensities.at(0), 10 + 1.5 * 64.0, 0.01);
  EXPECT_EQ(scans.at(0).intensities.at(1), 200.0F);
}

TEST(Hdl64eCalibrationFile, IsReadInAnyOrderOfLasers) {
  const Hdl64eCalibration written = random_calibration(1);
  const Hdl64eCalibration read = read_hdl_64e_calibration(yaml_of(written), "unit.yaml");
  VelodynePacket one = hdl_64e_packet(past_hour_us, 1234, 17);
  for (std::size_t block = 0; block < 12; ++block) {
    for (std::size_t shot = 0; shot < 32; ++shot)
      one.shot(block, shot, 1000 + 37U * static_cast<unsigned>(shot), 40);
  }
  const auto expected = decode(written, {one});
  const auto found = decode(read, {one});
  EXPECT_TRUE(found.at(0).points == expected.at(0).points);
  EXPECT_TRUE(found.at(0).intensities == expected.at(0).intensities);
  EXPECT_EQ(found.at(0).points.size(), 384U);
}

TEST(Hdl64eCalibrationFile, WhatIsWrongIsNamed) {
  const std::string good = yaml_of(random_calibration(2));
  const auto error = [](const std::string& text) {
    return error_of(Fault::input, [&] { read_hdl_64e_calibration(text, "unit.yaml"); });
  };
  EXPECT_THAT(error(""), HasSubstr("unit.yaml: is no calibration of an HDL-64E"));
  EXPECT_THAT(error("lasers: [1, 2"), HasSubstr("is no YAML"));
  EXPECT_THAT(error("lasers: [1, 2]"), HasSubstr("64 lasers"));
  const auto with = [&](const std::string& from, const std::string& to) {
    std::string text = good;
    return text.replace(text.find(from), from.size(), to);
  };
  EXPECT_THAT(error(with("laser_id: 62,", "laser_id: 63,")), HasSubstr("repeats laser_id 63"));
  EXPECT_THAT(error(with("laser_id: 62,", "laser_id: 64,")), HasSubstr("not 0 to 63"));
  EXPECT_THAT(error(with("rot_correction", "rot")),
              HasSubstr("entry 1 of lasers has no number rot_correction"));
  EXPECT_THAT(error(with("vert_correction: ", "vert_correction: x")), HasSubstr("vert_correction"));
}

TEST(Hdl64eDecoder, WithoutItsCalibrationItIsRefusedWithTheCure) {
  const auto decoder = make_velodyne_decoder();
  try {
    decoder->add(hdl_64e_packet(past_hour_us, 0, 17).bytes(), host_ns);
    FAIL();
  } catch (const Refusal& refusal) {
    EXPECT_THAT(refusal.what(), HasSubstr("HDL-64E"));
    EXPECT_THAT(refusal.what(), HasSubstr("--calibration"));
  }
}

TEST(Hdl64eDecoder, AnotherVelodyneIsRefused) {
  const auto decoder = make_hdl_64e_decoder({});
  EXPECT_THROW(decoder->add(VelodynePacket(0x22, 0x37, 0).bytes(), host_ns), Refusal);
}

TEST(Hdl64eDecoder, OtherTrafficAndDamageAreCounted) {
  const auto decoder = make_hdl_64e_decoder({});
  decoder->add({}, host_ns);
  decoder->add(hdl_64e_packet(past_hour_us, 0, 17).shot(0, 0, 5000, 1).bytes(), host_ns);
  decoder->add(hdl_64e_packet(past_hour_us + 288, 0, 17).mark(4, 0x1234).bytes(), host_ns);
  decoder->finish();
  EXPECT_EQ(decoder->counts().foreign, 1U);
  EXPECT_EQ(decoder->counts().damaged, 1U);
  EXPECT_EQ(decoder->counts().decoded, 1U);
}

TEST(Hdl64eDecoder, NothingBadComesOfRandomBytes) {
  std::mt19937 random(3);
  for (int round = 0; round < 50; ++round) {
    const auto decoder = make_hdl_64e_decoder(random_calibration(4));
    for (int i = 0; i < 40; ++i) {
      std::vector<std::byte> bytes = hdl_64e_packet(past_hour_us, 0, 17).bytes();
      for (int change = 0; change < 200; ++change) {
        // Marks stay, so that packets are looked into.
        const std::size_t at = random() % bytes.size();
        if (at >= 1200 || at % 100 >= 2) bytes[at] = static_cast<std::byte>(random() & 255U);
      }
      for (std::size_t block = 0; block < 12; ++block) {
        bytes[block * 100 + 3] =
            static_cast<std::byte>(std::to_integer<unsigned>(bytes[block * 100 + 3]) % 140U);
      }
      decoder->add(bytes, static_cast<std::int64_t>(random()) * 1'000'000'000);
    }
    decoder->finish();
    for (const Scan& scan : take_all(*decoder)) {
      for (const auto& point : scan.points) EXPECT_TRUE(point.allFinite());
    }
  }
}

}  // namespace
}  // namespace kissmap
