// SPDX-License-Identifier: MIT
// Messages with packets of sensors, from bytes made by hand.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "formats/clouds/refusal.hpp"
#include "formats/hesai_packets.hpp"
#include "formats/message_scans.hpp"
#include "formats/messages/packet_message.hpp"
#include "formats/velodyne_packets.hpp"

namespace kissmap {
namespace {

using test::little;
using test::ros_forms;
using test::RosBytes;
using test::RosForm;
using testing::Optional;

constexpr std::int64_t second_ns = 1'000'000'000;

/// How a driver lays out the packets of a message.
enum class Layout : std::uint8_t { velodyne, pandar, sized, unsized };

struct DriverMessage {
  const char* type;
  Layout layout;
  SensorFamily family;
};

const std::vector<DriverMessage> driver_messages{
    {"velodyne_msgs/VelodyneScan", Layout::velodyne, SensorFamily::velodyne},
    {"pandar_msgs/PandarScan", Layout::pandar, SensorFamily::hesai},
    {"hesai_lidar/PandarScan", Layout::sized, SensorFamily::hesai},
    {"hesai_ros_driver/UdpFrame", Layout::sized, SensorFamily::hesai},
    {"nebula_msgs/NebulaPackets", Layout::unsized, SensorFamily::hesai}};

struct TestPacket {
  std::uint32_t seconds;
  std::uint32_t nanoseconds;
  std::string payload;
};

std::string message_of(RosForm form, Layout layout, const std::vector<TestPacket>& packets) {
  RosBytes bytes(form);
  bytes.header(1'700'000'000, 5, "sensor");
  bytes.add<std::uint32_t>(static_cast<std::uint32_t>(packets.size()));
  for (const TestPacket& packet : packets) {
    bytes.time(packet.seconds, packet.nanoseconds);
    std::string room = packet.payload;  // of a fixed size
    room.resize(1500, '~');
    const auto size = static_cast<std::uint32_t>(packet.payload.size());
    if (layout == Layout::velodyne) bytes.raw(packet.payload);
    if (layout == Layout::pandar) bytes.raw(room).add<std::uint32_t>(size);
    if (layout == Layout::sized) bytes.sequence(packet.payload).add<std::uint32_t>(size);
    if (layout == Layout::unsized) bytes.sequence(packet.payload);
  }
  return bytes.bytes();
}

struct FoundPacket {
  std::string payload;
  std::int64_t ns;
  friend bool operator==(const FoundPacket&, const FoundPacket&) = default;
};

std::vector<FoundPacket> packets_in(const std::string& bytes, const Topic& topic) {
  std::vector<FoundPacket> found;
  for_each_packet(
      {0, test::received_ns, test::bytes_of(bytes)},
      topic,
      [&](std::span<const std::byte> packet, std::int64_t ns) {
        found.push_back({{reinterpret_cast<const char*>(packet.data()), packet.size()}, ns});
      });
  return found;
}

// Sizes that are no multiple of four: what follows a packet in CDR has to be aligned anew.
std::vector<TestPacket> packets_of(Layout layout) {
  return {{1'700'000'001, 2, std::string(1206, 'a')},
          {1'700'000'003, 4, std::string(layout == Layout::velodyne ? 1206 : 813, 'b')},
          {0, 0, std::string(1206, 'c')}};  // a driver that left the stamp empty
}

TEST(PacketMessages, GiveEveryPacketWithItsTime) {
  for (const DriverMessage& driver : driver_messages) {
    for (const RosForm form : ros_forms) {
      SCOPED_TRACE(std::string(driver.type) + " " + std::to_string(static_cast<int>(form)));
      const auto packets = packets_of(driver.layout);
      const Topic topic = test::topic_of(form, driver.type);
      const std::vector<FoundPacket> expected{{packets[0].payload, 1'700'000'001 * second_ns + 2},
                                              {packets[1].payload, 1'700'000'003 * second_ns + 4},
                                              {packets[2].payload, test::received_ns}};
      const std::string whole = message_of(form, driver.layout, packets);
      EXPECT_TRUE(packets_in(whole, topic) == expected);
      EXPECT_TRUE(packets_in(message_of(form, driver.layout, {}), topic).empty());
      EXPECT_THAT(packet_family(topic), Optional(driver.family));
      for (std::size_t cut = 1; cut <= whole.size(); cut += 7) {
        EXPECT_THROW(packets_in(whole.substr(0, whole.size() - cut), topic), Refusal) << cut;
      }
    }
  }
}

TEST(PacketMessages, ASizeBeyondTheRoomGivesTheRoom) {
  for (const RosForm form : ros_forms) {
    RosBytes bytes(form);
    bytes.header(1'700'000'000, 5, "sensor").add<std::uint32_t>(1).time(1, 0);
    bytes.raw(std::string(1500, 'p')).add<std::uint32_t>(4'000'000'000);
    const auto found = packets_in(bytes.bytes(), test::topic_of(form, "pandar_msgs/PandarScan"));
    ASSERT_EQ(found.size(), 1U);
    EXPECT_EQ(found[0].payload, std::string(1500, 'p'));
  }
}

TEST(PacketMessages, OfOusterAreOnePacketEach) {
  for (const char* type :
       {"ouster_ros/PacketMsg", "ouster_sensor_msgs/PacketMsg", "ouster_msgs/PacketMsg"}) {
    for (const RosForm form : ros_forms) {
      const Topic topic = test::topic_of(form, type, "/ouster/lidar_packets");
      const std::string bytes = RosBytes(form).sequence("packet").bytes();
      EXPECT_TRUE(packets_in(bytes, topic) ==
                  (std::vector<FoundPacket>{{"packet", test::received_ns}}));
      EXPECT_THAT(packet_family(topic), Optional(SensorFamily::ouster));
      EXPECT_EQ(packet_family(test::topic_of(form, type, "/ouster/imu_packets")), std::nullopt);
    }
  }
}

TEST(PacketMessages, OfOtherTypesAndEncodingsAreNone) {
  for (const char* type :
       {"sensor_msgs/PointCloud2", "velodyne_msgs/VelodynePacket", "", "PacketMsg"})
    EXPECT_EQ(packet_family(test::topic_of(RosForm::ros1, type)), std::nullopt) << type;
  const Topic protobuf{"/a", "velodyne_msgs/VelodyneScan", MessageEncoding::protobuf, std::nullopt};
  EXPECT_EQ(packet_family(protobuf), std::nullopt);
}

std::string text_of(const std::vector<std::byte>& bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

// One return of a VLP-16: laser 0 looks 15 degrees down, 10 m away.
TEST(PacketMessages, OfVelodyneBecomeASweep) {
  test::VelodynePacket packet(0x22, 0x37, 800'000'000);
  packet.shot(0, 0, 5000, 9);
  for (const RosForm form : ros_forms) {
    const std::string message =
        message_of(form, Layout::velodyne, {{1'700'000'000, 0, text_of(packet.bytes())}});
    const Scan scan =
        test::scan_of_message(message, test::topic_of(form, "velodyne_msgs/VelodyneScan"));
    ASSERT_EQ(scan.points.size(), 1U);
    EXPECT_LT((scan.points[0] - Eigen::Vector3f(9.6593F, 0, -2.5882F)).norm(), 1e-4F);
    EXPECT_EQ(scan.stamp_ns, 1'700'000'000 * second_ns);
  }
}

// One return of an XT-32: laser 16 looks level, to the front at 90 degrees, 10 m away.
TEST(PacketMessages, OfHesaiBecomeASweep) {
  test::HesaiPacketBytes packet(test::xt_32_kind, 0x37);
  for (std::size_t block = 0; block < 8; ++block) packet.azimuth(block, 9000);
  packet.shot(0, 15, 2500, 9);
  for (const DriverMessage& driver : driver_messages) {
    if (driver.family != SensorFamily::hesai) continue;
    for (const RosForm form : ros_forms) {
      const std::string message =
          message_of(form, driver.layout, {{1'700'000'000, 0, text_of(packet.bytes())}});
      const Scan scan = test::scan_of_message(message, test::topic_of(form, driver.type));
      ASSERT_EQ(scan.points.size(), 1U) << driver.type;
      EXPECT_LT((scan.points[0] - Eigen::Vector3f(10, 0, 0)).norm(), 1e-4F);
    }
  }
}

constexpr std::int64_t sensor_ns = 1'700'000'000 * second_ns;

const char* const ouster_metadata =
    R"({"prod_line": "OS-1-2", "lidar_mode": "1024x10", "beam_altitude_angles": [0.0, 30.0],
        "beam_azimuth_angles": [0.0, 90.0], "lidar_origin_to_beam_origin_mm": 10.0,
        "lidar_to_sensor_transform": [-1,0,0,0, 0,-1,0,0, 0,0,1,36.18, 0,0,0,1],
        "initialization_id": 77,
        "data_format": {"pixels_per_column": 2, "columns_per_packet": 1,
                        "columns_per_frame": 1024, "udp_profile_lidar": "RNG19_RFL8_SIG16_NIR16"}})";

/// One column of two beams, the first with a return at 5 m.
std::string ouster_packet(std::uint16_t column) {
  std::string bytes =
      little<std::uint16_t>(1) + little<std::uint16_t>(3) + little<std::uint32_t>(77);
  bytes += std::string(24, '\0');
  bytes += little<std::int64_t>(sensor_ns + column * 100'000);
  bytes += little<std::uint16_t>(column) + little<std::uint16_t>(1);
  for (const std::uint32_t range_mm : {5000U, 0U}) {
    bytes += little<std::uint32_t>(range_mm) + little<std::uint16_t>(5) + little<std::uint16_t>(8);
    bytes += little<std::uint32_t>(0);
  }
  return bytes + std::string(32, '\0');
}

// The metadata is recorded beside the packets and may come after the first of them; some drivers
// send a byte more than the packet has.
TEST(PacketMessages, OfOusterWaitForTheMetadata) {
  for (const RosForm form : ros_forms) {
    const Topic packets = test::topic_of(form, "ouster_ros/PacketMsg", "/ouster/lidar_packets");
    const Topic metadata = test::topic_of(form, "std_msgs/String", "/ouster/metadata");
    const auto maker = make_sweep_maker(packets, {});
    EXPECT_TRUE(maker->wants(metadata));
    EXPECT_FALSE(maker->wants(test::topic_of(form, "std_msgs/String", "/rosout")));
    const auto add = [&](const Topic& topic, const std::string& bytes) {
      maker->add({0, sensor_ns + second_ns, test::bytes_of(bytes)}, topic);
    };
    add(packets, RosBytes(form).sequence(ouster_packet(0)).bytes());
    add(metadata, RosBytes(form).text(ouster_metadata).bytes());
    add(packets, RosBytes(form).sequence(ouster_packet(256) + '\0').bytes());
    maker->finish();
    const auto scan = maker->take();
    ASSERT_TRUE(scan.has_value());
    ASSERT_EQ(scan->points.size(), 2U);
    EXPECT_LT((scan->points[0] - Eigen::Vector3f(-5, 0, 0.03618F)).norm(), 1e-5F);
    EXPECT_LT((scan->points[1] - Eigen::Vector3f(0, 5, 0.03618F)).norm(), 1e-5F);
    EXPECT_NEAR(scan->time_offsets[1], 0.0256F, 1e-8F);
    EXPECT_EQ(scan->stamp_ns, sensor_ns);
  }
}

TEST(PacketMessages, OfOusterWithoutMetadataAreRefused) {
  const Topic packets =
      test::topic_of(RosForm::ros1, "ouster_ros/PacketMsg", "/ouster/lidar_packets");
  const auto maker = make_sweep_maker(packets, {});
  const std::string bytes = RosBytes(RosForm::ros1).sequence(ouster_packet(0)).bytes();
  maker->add({0, test::received_ns, test::bytes_of(bytes)}, packets);
  EXPECT_THROW(maker->finish(), Refusal);
}

}  // namespace
}  // namespace kissmap
