// SPDX-License-Identifier: MIT
#include "formats/sensors/ouster_decoder.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "formats/clouds/refusal.hpp"
#include "formats/ouster_packets.hpp"
#include "formats/sensors/ouster_packet.hpp"
#include "formats/support.hpp"

namespace kissmap {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using test::Bytes;
using test::bytes_of;
using test::error_of;
using test::ouster_metadata_of;
using test::small_ouster;
using testing::HasSubstr;

constexpr std::int64_t host_ns = 1'700'000'000'000'000'000;

// RNG19_RFL8_SIG16_NIR16: every pixel of column c at range_mm, signal c, in columns first, first +
// 1 ...
std::string packet(std::uint16_t frame,
                   std::uint16_t first,
                   std::uint32_t range_mm,
                   std::uint32_t session = 77) {
  Bytes bytes;
  bytes.add<std::uint16_t>(1).add<std::uint16_t>(frame).add<std::uint32_t>(session);
  bytes.pad(24);
  for (std::uint16_t i = 0; i < 16; ++i) {
    const auto column = static_cast<std::uint16_t>(first + i);
    bytes.add<std::uint64_t>(static_cast<std::uint64_t>(host_ns) + frame * 100'000'000ULL +
                             column * 97'000ULL);
    bytes.add<std::uint16_t>(column).add<std::uint16_t>(1);
    for (int beam = 0; beam < 2; ++beam) {
      bytes.add<std::uint32_t>(range_mm).add<std::uint16_t>(5).add<std::uint16_t>(column);
      bytes.add<std::uint32_t>(0);
    }
  }
  bytes.pad(32);
  return bytes.text();
}

std::vector<Scan> sweeps_of(PacketDecoder& decoder) {
  decoder.finish();
  std::vector<Scan> sweeps;
  while (auto scan = decoder.take()) sweeps.push_back(std::move(*scan));
  return sweeps;
}

TEST(OusterDecoder, PlacesPointsByTheManualsFormula) {
  const auto decoder =
      make_ouster_decoder(ouster_metadata_of(small_ouster("RNG19_RFL8_SIG16_NIR16")));
  decoder->add(bytes_of(packet(3, 0, 5000)), host_ns);
  decoder->add(bytes_of(packet(3, 256, 5000)), host_ns);
  const auto sweeps = sweeps_of(*decoder);
  ASSERT_EQ(sweeps.size(), 1U);
  const Scan& scan = sweeps[0];
  require_consistent(scan);
  ASSERT_EQ(scan.points.size(), 64U);
  // Level beam, encoder at 0: along -x of the sensor, whose lidar frame is turned by 180 degrees.
  EXPECT_LT((scan.points[0] - Eigen::Vector3f(-5.0F, 0.0F, 0.03618F)).norm(), 1e-6F);
  // 30 degrees up, and 90 degrees aside of the encoder, seen from 1 cm in front of the axis.
  const double r = 4990.0;
  const Eigen::Vector3d aside(-10.0, r * std::cos(M_PI / 6), r * std::sin(M_PI / 6) + 36.18);
  EXPECT_LT((scan.points[1].cast<double>() - 1e-3 * aside).norm(), 1e-6);
  // A quarter of a turn later the encoder has gone clockwise.
  EXPECT_LT((scan.points[32] - Eigen::Vector3f(0.0F, 5.0F, 0.03618F)).norm(), 1e-6F);
  EXPECT_EQ(scan.intensities[34], 257.0F);
  EXPECT_EQ(scan.stamp_ns, host_ns + 300'000'000);
  EXPECT_NEAR(scan.time_offsets[32], 256 * 97e-6, 1e-9);
}

TEST(OusterDecoder, FramesWrapAndTakePacketsThatComeLate) {
  const auto decoder =
      make_ouster_decoder(ouster_metadata_of(small_ouster("RNG19_RFL8_SIG16_NIR16")));
  decoder->add(bytes_of(packet(65535, 0, 5000)), host_ns);
  decoder->add(bytes_of(packet(0, 0, 5000)), host_ns);
  decoder->add(bytes_of(packet(65535, 16, 5000)), host_ns);
  decoder->add(bytes_of(packet(1, 0, 5000)), host_ns);
  decoder->add(bytes_of(packet(1, 0, 7000)), host_ns);  // sent twice
  const auto sweeps = sweeps_of(*decoder);
  ASSERT_EQ(sweeps.size(), 3U);
  EXPECT_EQ(sweeps[0].points.size(), 64U);
  EXPECT_EQ(sweeps[1].points.size(), 32U);
  EXPECT_EQ(sweeps[2].points.size(), 32U);
}

TEST(OusterDecoder, OtherSessionsSizesAndInvalidColumnsAreLeftOut) {
  const auto decoder =
      make_ouster_decoder(ouster_metadata_of(small_ouster("RNG19_RFL8_SIG16_NIR16")));
  decoder->add(bytes_of(packet(0, 0, 5000, 78)), host_ns);
  decoder->add(bytes_of(packet(0, 0, 5000).substr(1)), host_ns);
  decoder->add(bytes_of(packet(0, 1020, 5000)), host_ns);  // columns 1024 ... do not exist
  EXPECT_EQ(decoder->counts().foreign, 2U);
  EXPECT_EQ(decoder->counts().decoded, 1U);
  EXPECT_EQ(decoder->counts().damaged, 12U);
  const auto sweeps = sweeps_of(*decoder);
  ASSERT_EQ(sweeps.size(), 1U);
  EXPECT_EQ(sweeps[0].points.size(), 8U);
}

TEST(OusterDecoder, AClockThatCountsFromPowerOnIsNotAStamp) {
  const auto decoder =
      make_ouster_decoder(ouster_metadata_of(small_ouster("RNG19_RFL8_SIG16_NIR16")));
  const std::int64_t later = host_ns + 10 * 86'400'000'000'000;
  decoder->add(bytes_of(packet(0, 0, 5000)), later);
  const auto sweeps = sweeps_of(*decoder);
  ASSERT_EQ(sweeps.size(), 1U);
  EXPECT_EQ(sweeps[0].stamp_ns, later);
  EXPECT_NEAR(sweeps[0].time_offsets[2], 97e-6, 1e-9);
}

TEST(OusterDecoder, UnknownProfilesAreRefusedByName) {
  try {
    make_ouster_decoder(ouster_metadata_of(small_ouster("RNG99_ODD")));
    ADD_FAILURE();
  } catch (const Refusal& refusal) {
    EXPECT_THAT(refusal.what(), HasSubstr("RNG99_ODD"));
  }
}

TEST(OusterDecoder, HostilePayloadsDoNoHarm) {
  std::uint32_t noise = 1;
  for (const char* profile : {"LEGACY",
                              "RNG19_RFL8_SIG16_NIR16",
                              "RNG19_RFL8_SIG16_NIR16_DUAL",
                              "RNG15_RFL8_NIR8",
                              "RNG15_RFL8_NIR8_DUAL",
                              "FIVE_WORD_PIXEL"}) {
    json values = small_ouster(profile);
    values.erase("initialization_id");
    const OusterMetadata about = ouster_metadata_of(values);
    const auto decoder = make_ouster_decoder(about);
    const std::size_t size = OusterPackets(about).packet_bytes();
    for (std::size_t length = 0; length < size + 3; ++length) {
      std::string payload(length, '\0');
      for (char& byte : payload) {
        noise = noise * 1664525U + 1013904223U;
        byte = static_cast<char>(noise >> 24U);
      }
      decoder->add(bytes_of(payload), host_ns);
    }
    for (const Scan& scan : sweeps_of(*decoder)) require_consistent(scan);
  }
}

TEST(OusterMetadata, NestedLayoutIsTheSame) {
  const json flat = small_ouster("RNG15_RFL8_NIR8");
  json nested;
  nested["sensor_info"] = {{"prod_line", flat["prod_line"]}, {"initialization_id", 77}};
  nested["config_params"] = {{"lidar_mode", "1024x10"}, {"udp_port_lidar", 7502}};
  nested["lidar_data_format"] = flat["data_format"];
  nested["beam_intrinsics"] = {
      {"beam_altitude_angles", flat["beam_altitude_angles"]},
      {"beam_azimuth_angles", flat["beam_azimuth_angles"]},
      {"lidar_origin_to_beam_origin_mm", flat["lidar_origin_to_beam_origin_mm"]}};
  nested["lidar_intrinsics"] = {{"lidar_to_sensor_transform", flat["lidar_to_sensor_transform"]}};
  const OusterMetadata a = ouster_metadata_of(flat);
  const OusterMetadata b = ouster_metadata_of(nested);
  EXPECT_EQ(a.product, b.product);
  EXPECT_EQ(b.profile, "RNG15_RFL8_NIR8");
  EXPECT_EQ(a.beams, b.beams);
  EXPECT_EQ(a.columns_per_frame, b.columns_per_frame);
  EXPECT_EQ(a.altitudes_deg, b.altitudes_deg);
  EXPECT_EQ(a.initialization_id, b.initialization_id);
  EXPECT_EQ(a.lidar_from_beam_origin_mm, b.lidar_from_beam_origin_mm);
  EXPECT_TRUE(a.sensor_from_lidar_mm.isApprox(b.sensor_from_lidar_mm));
}

TEST(OusterMetadata, ErrorsNameFileAndKey) {
  const auto error = [](json values, const char* key, const json& value) {
    if (value.is_null()) {
      values.erase(key);
    } else {
      values[key] = value;
    }
    return error_of(Fault::input, [&] { ouster_metadata_of(values); });
  };
  const json good = small_ouster("LEGACY");
  EXPECT_THAT(error(good, "beam_altitude_angles", nullptr),
              HasSubstr("'beam_altitude_angles' is missing"));
  EXPECT_THAT(error(good, "beam_azimuth_angles", {1.0}), HasSubstr("m.json"));
  EXPECT_THAT(error(good, "prod_line", 5), HasSubstr("'prod_line' is not of the right kind"));
  EXPECT_THAT(error(good, "pixels_per_column", -1), HasSubstr("'pixels_per_column' is -1"));
  EXPECT_THAT(error_of(Fault::input, [] { read_ouster_metadata("[1]", "m.json"); }),
              HasSubstr("no JSON"));
}

// Three scans of one place, put together by the maker's poses, lie on each other.
TEST(OusterRecording, ScansOfOnePlaceAgreeByTheirPoses) {
  const char* data = std::getenv("KISSMAP_TEST_DATA");
  if (data == nullptr) GTEST_SKIP() << "needs the recordings";
  const fs::path folder = fs::path(data) / "packets/ouster";
  const auto log = open_log(folder / "OS-1-128_v2.3.0_1024x10_lb_n3.pcap");
  std::ifstream poses(folder / "OS-1-128_v2.3.0_1024x10_lb_n3_poses_kitti.txt");
  std::vector<std::vector<Eigen::Vector3f>> clouds;
  for (const LogEntry& entry : test::read_all(*log)) {
    Eigen::Matrix<float, 3, 4> pose;
    for (Eigen::Index i = 0; i < 12; ++i) poses >> pose(i / 4, i % 4);
    auto& cloud = clouds.emplace_back();
    const Scan& scan = test::scan_of(entry);
    for (std::size_t i = 0; i < scan.points.size(); i += 97) {
      const Eigen::Vector3f& p = scan.points[i];
      if (p.norm() < 15.0F) cloud.push_back(pose.leftCols<3>() * p + pose.col(3));
    }
    if (clouds.size() > 1) continue;
    cloud.clear();  // of the first scan all points
    for (const Eigen::Vector3f& p : scan.points)
      cloud.push_back(pose.leftCols<3>() * p + pose.col(3));
  }
  ASSERT_EQ(clouds.size(), 3U);
  std::vector<float> distances;
  for (const Eigen::Vector3f& p : clouds[2]) {
    float nearest = 1e9F;
    for (const Eigen::Vector3f& q : clouds[0]) nearest = std::min(nearest, (p - q).squaredNorm());
    distances.push_back(std::sqrt(nearest));
  }
  ASSERT_GT(distances.size(), 300U);
  std::ranges::nth_element(distances,
                           distances.begin() + static_cast<std::ptrdiff_t>(distances.size() / 2));
  EXPECT_LT(distances[distances.size() / 2], 0.05F);
}

}  // namespace
}  // namespace kissmap
