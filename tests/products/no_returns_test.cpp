// SPDX-License-Identifier: MIT
// Shots that nothing came back of: which a decoder tells, in what direction, and when.
#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>

#include "formats/hesai_packets.hpp"
#include "formats/sensor_recording.hpp"
#include "formats/sensors/hdl_64e_decoder.hpp"
#include "formats/sensors/hesai_decoder.hpp"
#include "formats/sensors/ouster_decoder.hpp"
#include "formats/sensors/sweep_builder.hpp"
#include "formats/sensors/velodyne_decoder.hpp"
#include "formats/support.hpp"
#include "formats/velodyne_packets.hpp"

namespace kissmap {
namespace {

using test::bytes_of;
using test::HesaiPacketBytes;
using test::take_all;
using test::VelodynePacket;

constexpr double degree = std::numbers::pi / 180.0;
constexpr unsigned vlp_16 = 0x22;
constexpr unsigned strongest = 0x37;
constexpr unsigned dual = 0x39;
constexpr unsigned triple = 0x3D;
constexpr std::int64_t host_ns = 1'700'000'000'000'000'000;  // 472222 h + 800 s
constexpr std::uint32_t past_hour_us = 800'000'000;

Scan only_sweep(PacketDecoder& decoder, const std::vector<std::vector<std::byte>>& packets) {
  for (const std::vector<std::byte>& packet : packets) decoder.add(packet, host_ns);
  decoder.finish();
  const std::vector<Scan> sweeps = take_all(decoder);
  EXPECT_EQ(sweeps.size(), 1U);
  EXPECT_NO_THROW(require_consistent(sweeps.at(0)));
  return sweeps.at(0);
}

Scan velodyne(const VelodynePacket& packet) {
  return only_sweep(*make_velodyne_decoder(), {packet.bytes()});
}

Scan hesai(const HesaiPacketBytes& packet) {
  return only_sweep(*make_hesai_decoder({}), {packet.bytes()});
}

void expect_shot(const Scan& scan, std::size_t i, const Eigen::Vector3d& direction, double us) {
  ASSERT_LT(i, scan.no_return_directions.size());
  ASSERT_EQ(scan.no_return_time_offsets.size(), scan.no_return_directions.size());
  EXPECT_LT((scan.no_return_directions[i].cast<double>() - direction).norm(), 1e-6);
  EXPECT_NEAR(scan.no_return_time_offsets[i], 1e-6 * us, 1e-9);
}

// Shot 0 looks 15 degrees down, shot 1 one degree up; 2.304 us from shot to shot.
TEST(NoReturnsOfAVlp16, HaveTheirDirectionAndTime) {
  VelodynePacket packet(vlp_16, strongest, past_hour_us);
  const Scan scan = velodyne(packet.azimuths(9000).shot(0, 0, 5000, 9));
  ASSERT_EQ(scan.points.size(), 1U);
  ASSERT_EQ(scan.no_return_directions.size(), 31U) << "of blocks 1 to 11 nothing came back at all";
  expect_shot(scan, 0, {0.0, -std::cos(degree), std::sin(degree)}, 2.304);
  // The same laser in the second firing of the block.
  expect_shot(scan, 16, {0.0, -std::cos(degree), std::sin(degree)}, 55.296 + 2.304);
}

TEST(NoReturnsOfAVlp16, TurnWithTheSensor) {
  VelodynePacket packet(vlp_16, strongest, past_hour_us);
  for (std::size_t block = 0; block < VelodynePacket::blocks; ++block) {
    packet.azimuth(block, 9000 + 40 * static_cast<long>(block)).shot(block, 0, 5000, 9);
  }
  const Scan scan = velodyne(packet);
  ASSERT_EQ(scan.no_return_directions.size(), 12U * 31U);
  // 0.4 degrees a block of 110.592 us.
  const double us = 3 * 110.592 + 55.296 + 2.304;
  const double azimuth = (90.0 + 0.4 * us / 110.592) * degree;
  expect_shot(scan,
              3 * 31 + 16,
              {std::cos(degree) * std::cos(azimuth),
               -std::cos(degree) * std::sin(azimuth),
               std::sin(degree)},
              us);
}

TEST(NoReturnsOfAVlp16, AreThoseOfWhichNeitherReturnCame) {
  VelodynePacket packet(vlp_16, dual, past_hour_us);
  packet.azimuths(0).shot(0, 0, 5000, 9).shot(1, 0, 5000, 9);  // the same twice
  packet.shot(0, 2, 4000, 9).shot(1, 4, 4000, 9);              // one of the two is missing
  const Scan scan = velodyne(packet);
  EXPECT_EQ(scan.points.size(), 3U);
  EXPECT_EQ(scan.no_return_directions.size(), 29U);
}

TEST(NoReturnsOfAnHdl64E, LookWhereItsCalibrationSays) {
  Hdl64eCalibration calibration{};
  calibration[3].rotation = 0.1;
  calibration[3].elevation = -0.2;
  std::vector<std::vector<std::byte>> packets;
  for (std::uint32_t i = 0; i < 2; ++i) {
    VelodynePacket packet(0x17, 0, past_hour_us + 288 * i);
    for (std::size_t block = 0; block < VelodynePacket::blocks; ++block) {
      packet.mark(block, block % 2 == 0 ? 0xEEFF : 0xDDFF).azimuth(block, 9000);
    }
    packets.push_back(packet.shot(0, 0, 5000, 9).bytes());
  }
  const Scan scan = only_sweep(*make_hdl_64e_decoder(calibration), packets);
  ASSERT_EQ(scan.points.size(), 2U);
  ASSERT_EQ(scan.no_return_directions.size(), 2U * 63U);
  const double azimuth = 90.0 * degree - 0.1;
  const Eigen::Vector3d expected(
      std::cos(0.2) * std::cos(azimuth), -std::cos(0.2) * std::sin(azimuth), -std::sin(0.2));
  EXPECT_LT((scan.no_return_directions[2].cast<double>() - expected).norm(), 1e-6);
}

TEST(NoReturnsOfAnXt32, HaveTheirDirectionAndTime) {
  HesaiPacketBytes packet(test::xt_32_kind, strongest);
  const Scan scan = hesai(packet.azimuth(0, 9000).shot(0, 0, 2500, 9));
  ASSERT_EQ(scan.points.size(), 1U);
  ASSERT_EQ(scan.no_return_directions.size(), 31U);
  expect_shot(scan, 14, {1.0, 0.0, 0.0}, 15 * 1.512);  // laser 16 looks level
}

TEST(NoReturnsOfHesais, AreThoseOfWhichNoReturnCame) {
  HesaiPacketBytes packet(test::xt_32_kind, dual);
  packet.shot(0, 0, 2500, 9).shot(0, 1, 2500, 9).shot(1, 1, 2500, 9).shot(1, 2, 2500, 9);
  const Scan two = hesai(packet);
  EXPECT_EQ(two.points.size(), 3U);
  EXPECT_EQ(two.no_return_directions.size(), 29U);
  HesaiPacketBytes of_three(test::xt_32m_kind, triple);
  of_three.shot(3, 0, 2500, 9).shot(4, 1, 2500, 9).shot(5, 2, 2500, 9);
  const Scan three = hesai(of_three);
  EXPECT_EQ(three.points.size(), 3U);
  EXPECT_EQ(three.no_return_directions.size(), 29U);
}

// A sensor of two beams: one is level and looks along the encoder, which begins at -x and turns
// clockwise, the other 30 degrees up and 90 degrees aside of it.
OusterMetadata small_ouster(const char* profile) {
  const nlohmann::json values = {
      {"prod_line", "OS-1-2"},
      {"lidar_mode", "1024x10"},
      {"beam_altitude_angles", {0.0, 30.0}},
      {"beam_azimuth_angles", {0.0, 90.0}},
      {"lidar_origin_to_beam_origin_mm", 10.0},
      {"lidar_to_sensor_transform", {-1, 0, 0, 0, 0, -1, 0, 0, 0, 0, 1, 36.18, 0, 0, 0, 1}},
      {"initialization_id", 77},
      {"data_format",
       {{"pixels_per_column", 2},
        {"columns_per_packet", 16},
        {"columns_per_frame", 1024},
        {"udp_profile_lidar", profile}}}};
  return read_ouster_metadata(values.dump(), "m.json");
}

// 16 columns, each 16 of the encoder's apart. `seen` are the words of the level beam in every
// second of them; it sees nothing in the others, and the other beam nothing at all.
Scan ouster(const char* profile, const std::vector<std::uint32_t>& seen) {
  test::Bytes packet;
  packet.add<std::uint16_t>(1).add<std::uint16_t>(3).add<std::uint32_t>(77).pad(24);
  for (std::uint16_t column = 0; column < 16; ++column) {
    packet.add<std::uint64_t>(static_cast<std::uint64_t>(host_ns) + 97'000ULL * column);
    packet.add<std::uint16_t>(static_cast<std::uint16_t>(16 * column));
    packet.add<std::uint16_t>(column == 8 ? 0 : 1);  // whether the column is valid
    for (const std::uint32_t word : seen) packet.add<std::uint32_t>(column % 2 == 0 ? word : 0);
    for (std::size_t k = 0; k < seen.size(); ++k) packet.add<std::uint32_t>(0);
  }
  packet.pad(32);
  const std::span<const std::byte> bytes = bytes_of(packet.text());
  return only_sweep(*make_ouster_decoder(small_ouster(profile)), {{bytes.begin(), bytes.end()}});
}

void expect_ouster_shots(const Scan& scan) {
  ASSERT_EQ(scan.no_return_directions.size(), 7U + 8U + 8U) << "of column 8 nothing is known";
  expect_shot(scan, 0, {0.0, std::cos(30 * degree), 0.5}, 0.0);
  // The level beam of the second column.
  const double turned = 2.0 * std::numbers::pi * 16 / 1024;
  expect_shot(scan, 1, {-std::cos(turned), std::sin(turned), 0.0}, 97.0);
}

TEST(NoReturnsOfAnOuster, HaveTheirDirectionAndTime) {
  const Scan scan = ouster("RNG19_RFL8_SIG16_NIR16", {5000, 1, 0});
  EXPECT_EQ(scan.points.size(), 7U);
  expect_ouster_shots(scan);
}

TEST(NoReturnsOfAnOuster, AreThoseOfWhichNeitherReturnCame) {
  const Scan scan = ouster("RNG19_RFL8_SIG16_NIR16_DUAL", {0, 5000, 1, 0});
  EXPECT_EQ(scan.points.size(), 7U) << "only the second return came";
  expect_ouster_shots(scan);
}

TEST(NoReturnsOfASweep, AreForgottenWhereAColumnHasNothingElse) {
  std::deque<Scan> sweeps;
  SweepBuilder builder(sweeps);
  const auto column = [&](std::int64_t number, bool returned) {
    const std::int64_t time_ns = host_ns + number * 100'000;
    builder.begin_column(0.36 * static_cast<double>(number), time_ns, host_ns, 3);
    builder.add_no_return({1.0F, 0.0F, 0.0F}, time_ns);
    if (returned) builder.add({1.0F, 2.0F, 3.0F}, 4.0F, time_ns + 50'000);
    builder.add_no_return({0.0F, 1.0F, 0.0F}, time_ns + 70'000);
  };
  column(0, false);
  column(1, true);
  column(2, false);
  column(3, true);
  column(4, false);
  builder.finish();
  ASSERT_EQ(sweeps.size(), 1U);
  require_consistent(sweeps[0]);
  EXPECT_EQ(sweeps[0].stamp_ns, host_ns + 150'000) << "of the first point";
  ASSERT_EQ(sweeps[0].no_return_directions.size(), 4U);
  expect_shot(sweeps[0], 0, {1.0, 0.0, 0.0}, -50.0);
  expect_shot(sweeps[0], 1, {0.0, 1.0, 0.0}, 20.0);
  expect_shot(sweeps[0], 2, {1.0, 0.0, 0.0}, 150.0);
  // Nothing of one sweep is left for the next.
  builder.begin_column(0.0, host_ns + 5'000'000'000, host_ns, 1);
  builder.add({1.0F, 2.0F, 3.0F}, 4.0F, host_ns + 5'000'000'000);
  builder.finish();
  ASSERT_EQ(sweeps.size(), 2U);
  EXPECT_TRUE(sweeps[1].no_return_directions.empty());
}

}  // namespace
}  // namespace kissmap
