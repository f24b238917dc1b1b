// SPDX-License-Identifier: MIT
#include "formats/sensors/sensor_calibration.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "formats/capture_bytes.hpp"
#include "formats/hesai_packets.hpp"
#include "formats/sensors/hesai_angle_file.hpp"
#include "formats/velodyne_packets.hpp"
#include "kissmap/formats/registry.hpp"

namespace kissmap {
namespace {

namespace fs = std::filesystem;
using test::error_of;
using test::TempDir;
using testing::HasSubstr;

std::string angles_csv(std::size_t lasers, const std::string& first_line = "") {
  std::string text = first_line + "Laser id,Elevation,Azimuth\r\n";
  for (std::size_t i = 1; i <= lasers; ++i) {
    text += std::to_string(i) + "," + std::to_string(20.0 - static_cast<double>(i)) + "," +
            std::to_string(0.25 * static_cast<double>(i)) + "\r\n";
  }
  return text;
}

TEST(HesaiAngleFile, IsReadWithOrWithoutMarkAndFirstLine) {
  for (const std::string before : {"", "\xEF\xBB\xBF", "EEFF,1,1\r\n", "\r\n"}) {
    const HesaiAngles angles = read_hesai_angles(angles_csv(32, before), "unit.csv");
    ASSERT_EQ(angles.size(), 32U);
    EXPECT_DOUBLE_EQ(angles[0].elevation_deg, 19.0);
    EXPECT_DOUBLE_EQ(angles[31].azimuth_deg, 8.0);
  }
}

TEST(HesaiAngleFile, ColumnsAreFoundByName) {
  const HesaiAngles angles =
      read_hesai_angles("Azimuth, Channel ,Elevation,Note\n-1.042,1,+14.5,a\n3,2,-2,\n", "u.csv");
  ASSERT_EQ(angles.size(), 2U);
  EXPECT_DOUBLE_EQ(angles[0].elevation_deg, 14.5);
  EXPECT_DOUBLE_EQ(angles[0].azimuth_deg, -1.042);
  EXPECT_DOUBLE_EQ(angles[1].elevation_deg, -2.0);
}

TEST(HesaiAngleFile, WhatIsWrongIsNamedWithItsLine) {
  const auto error = [](const std::string& text) {
    return error_of(Fault::input, [&] { read_hesai_angles(text, "unit.csv"); });
  };
  const std::string head = "Channel,Elevation,Azimuth\n";
  EXPECT_THAT(error(""), HasSubstr("unit.csv: is no file of Hesai's angles"));
  EXPECT_THAT(error("a,b\n1,2\n"), HasSubstr("Channel, Elevation and Azimuth"));
  EXPECT_THAT(error(head), HasSubstr("names no channel"));
  EXPECT_THAT(error(head + "1,2\n"), HasSubstr("line 2: has 2 columns"));
  EXPECT_THAT(error(head + "1,2,3\n3,2,3\n"), HasSubstr("line 3: channel '3' instead of 2"));
  EXPECT_THAT(error(head + "1,nan,3\n"), HasSubstr("line 2: 'nan' is no elevation"));
  EXPECT_THAT(error(head + "1,91,3\n"), HasSubstr("line 2: '91' is no elevation"));
  EXPECT_THAT(error(head + "1,2,x\n"), HasSubstr("line 2: 'x' is no azimuth"));
}

std::string text_of_packet(const std::vector<std::byte>& bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

fs::path capture_of(const TempDir& dir, const std::vector<std::byte>& packet) {
  return dir.write("log.pcap",
                   test::pcap({test::ipv4(test::udp(2368, text_of_packet(packet)))}, 101));
}

Scan first_scan(const fs::path& capture, const std::string& calibration) {
  ReadOptions options;
  options.calibration = calibration;
  const auto log = open_log(capture, options);
  const auto entry = log->next();
  return std::get<Scan>(entry.value().content);
}

std::vector<std::byte> hesai_packet() {
  test::HesaiPacketBytes packet(test::xt_32_kind, 0x37);
  return packet.azimuth(0, 3000).shot(0, 15, 2500, 9).bytes();
}

std::vector<std::byte> hdl_64e_packet() {
  test::VelodynePacket packet(0, 0, 800'000'000);
  for (std::size_t block = 1; block < 12; block += 2) packet.mark(block, 0xDDFF);
  return packet.shot(0, 7, 5000, 9).bytes();
}

std::string hdl_64e_yaml() {
  std::string text = "lasers:\n";
  for (int i = 0; i < 64; ++i) {
    text += "- {laser_id: " + std::to_string(i) +
            ", rot_correction: 0.5, vert_correction: 0.25, dist_correction: 1.0}\n";
  }
  return text;
}

TEST(SensorCalibration, AnglesOfAHesaiUnitMoveItsPoints) {
  const TempDir dir;
  const fs::path capture = capture_of(dir, hesai_packet());
  const fs::path csv = dir.write("unit.csv", angles_csv(32));
  const Eigen::Vector3f typical = first_scan(capture, "").points.at(0);
  const Eigen::Vector3f unit = first_scan(capture, csv).points.at(0);
  const double radian = std::numbers::pi / 180.0;
  EXPECT_NEAR(std::asin(typical.z() / 10.0), 0.0, 1e-5);
  EXPECT_NEAR(std::asin(unit.z() / 10.0), 4.0 * radian, 1e-5);
  const auto azimuth = [](const Eigen::Vector3f& p) { return std::atan2(p.x(), p.y()); };
  EXPECT_NEAR(azimuth(unit) - azimuth(typical), 4.0 * radian, 1e-5);
}

TEST(SensorCalibration, MakesAnHdl64eReadable) {
  const TempDir dir;
  const fs::path capture = capture_of(dir, hdl_64e_packet());
  const fs::path yaml = dir.write("unit.yaml", hdl_64e_yaml());
  const Eigen::Vector3f point = first_scan(capture, yaml).points.at(0);
  EXPECT_NEAR(point.norm(), 11.0, 1e-4);
  EXPECT_NEAR(std::asin(point.z() / 11.0), 0.25, 1e-5);
  EXPECT_NEAR(std::atan2(point.y(), point.x()), 0.5, 1e-5);
  EXPECT_THAT(error_of(Fault::input, [&] { first_scan(capture, ""); }),
              HasSubstr("give it with --calibration"));
}

TEST(SensorCalibration, IsAmongTheFilesOfTheLog) {
  const TempDir dir;
  ReadOptions options;
  options.calibration = dir.write("unit.csv", angles_csv(32));
  const auto log = open_log(capture_of(dir, hesai_packet()), options);
  ASSERT_EQ(log->files().size(), 2U);
  EXPECT_EQ(log->files()[0].name, "unit.csv");
}

TEST(SensorCalibration, OfAnotherSensorIsAnError) {
  const TempDir dir;
  const fs::path hesai = capture_of(dir, hesai_packet());
  const fs::path yaml = dir.write("unit.yaml", hdl_64e_yaml());
  EXPECT_THAT(error_of(Fault::input, [&] { first_scan(hesai, yaml); }),
              HasSubstr("packets of a Hesai, but the calibration is not a file of its angles"));
  EXPECT_THAT(
      error_of(Fault::input, [&] { first_scan(hesai, dir.write("u.csv", angles_csv(31))); }),
      HasSubstr("has 32 lasers, and angles were given for 31"));
  EXPECT_THAT(error_of(Fault::usage, [&] { first_scan(hesai, dir.write("unit.txt", "x")); }),
              HasSubstr("--calibration"));
  EXPECT_THAT(error_of(Fault::input, [&] { first_scan(hesai, dir.path() / "none.csv"); }),
              HasSubstr("none.csv"));
}

}  // namespace
}  // namespace kissmap
