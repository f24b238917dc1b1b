// SPDX-License-Identifier: MIT
// Clouds of Livox and of Foxglove, from bytes made by hand.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "formats/clouds/refusal.hpp"
#include "formats/message_scans.hpp"

namespace kissmap {
namespace {

using test::hex;
using test::little;
using test::ProtobufBytes;
using test::ros_forms;
using test::RosBytes;
using test::RosForm;
using test::scan_of_message;
using testing::ElementsAre;

constexpr std::int64_t stamp_ns = 1'700'000'000'250'000'000;

std::string livox(RosForm form, std::uint32_t header_s, std::uint64_t timebase_ns, int points) {
  RosBytes bytes(form);
  bytes.header(header_s, 250'000'000, "livox").add<std::uint64_t>(timebase_ns);
  bytes.add<std::uint32_t>(static_cast<std::uint32_t>(points));
  bytes.add<std::uint8_t>(9).raw("rsv");
  bytes.add<std::uint32_t>(static_cast<std::uint32_t>(points));
  for (int k = 0; k < points; ++k) {
    const bool missing = k == 1;  // no return: all zeros
    bytes.add<std::uint32_t>(static_cast<std::uint32_t>(k) * 50'000'000U);
    for (const float coordinate : {1.5F + static_cast<float>(k), -2.25F, 0.125F})
      bytes.add<float>(missing ? 0.0F : coordinate);
    bytes.add<std::uint8_t>(static_cast<std::uint8_t>(200 + k)).add<std::uint8_t>(16);
    bytes.add<std::uint8_t>(3);
  }
  return bytes.bytes();
}

const char* const livox_types[] = {"livox_ros_driver/CustomMsg", "livox_ros_driver2/CustomMsg"};

TEST(LivoxCustomMsg, OfBothDriversInEveryEncoding) {
  for (const char* type : livox_types) {
    for (const RosForm form : ros_forms) {
      const std::string message = livox(form, 1'700'000'000, 1'700'000'000'250'000'123, 3);
      // 19 bytes a point; in CDR one more before the next, whose first number has four.
      EXPECT_EQ(message.size(), form == RosForm::ros1 ? 21U + 20 + 57 : 4U + 24 + 20 + 59);
      const Scan scan = scan_of_message(message, test::topic_of(form, type));
      EXPECT_EQ(scan.stamp_ns, 1'700'000'000'250'000'123);
      EXPECT_THAT(scan.points,
                  ElementsAre(Eigen::Vector3f(1.5F, -2.25F, 0.125F),
                              Eigen::Vector3f(3.5F, -2.25F, 0.125F)));
      EXPECT_THAT(scan.intensities, ElementsAre(200, 202));
      EXPECT_THAT(scan.time_offsets, ElementsAre(0.0F, 0.1F));
      EXPECT_EQ(scan.stamp_instant, StampInstant::sweep_start);
      EXPECT_EQ(scan.dropped, (DroppedReturns{0, 1, 0}));
    }
  }
}

TEST(LivoxCustomMsg, OfASensorWithAClockOfItsOwnKeepsTheHeadersStamp) {
  for (const RosForm form : ros_forms) {
    const Topic topic = test::topic_of(form, livox_types[1]);
    const Scan scan = scan_of_message(livox(form, 1'700'000'000, 812'000'000'000, 3), topic);
    EXPECT_EQ(scan.stamp_ns, stamp_ns);
    EXPECT_THAT(scan.time_offsets, ElementsAre(0.0F, 0.1F));
    EXPECT_EQ(scan_of_message(livox(form, 1'700'000'000, 0, 0), topic).points.size(), 0U);
  }
}

TEST(LivoxCustomMsg, CutAnywhereIsRefused) {
  for (const RosForm form : ros_forms) {
    const std::string whole = livox(form, 1'700'000'000, 1'700'000'000'250'000'000, 3);
    for (std::size_t size = 0; size < whole.size(); ++size) {
      EXPECT_THROW(scan_of_message(whole.substr(0, size), test::topic_of(form, livox_types[1])),
                   Refusal)
          << size;
    }
  }
}

const Topic foxglove_topic{
    "/points", "foxglove.PointCloud", MessageEncoding::protobuf, std::nullopt};

std::string foxglove_time(std::uint64_t seconds, std::uint64_t nanoseconds) {
  return ProtobufBytes().varint(1, seconds).varint(2, nanoseconds).bytes();
}
std::string foxglove_field(const std::string& name, std::uint32_t offset, std::uint64_t type) {
  return ProtobufBytes().block(1, name).fixed32(2, offset).varint(3, type).bytes();
}

/// The number of a type, and numbers of it with the highest byte first.
struct FoxgloveType {
  std::uint64_t number;
  const char* x;
  const char* brightness;
  float x_value;
  float brightness_value;
};

TEST(FoxglovePointCloud, NumbersItsTypesOtherwiseThanRos) {
  const std::vector<FoxgloveType> types{{1, "7F", "C8", 127, 200},
                                        {2, "FD", "C8", -3, -56},
                                        {3, "012C", "9C40", 300, 40000},
                                        {4, "FED4", "9C40", -300, -25536},
                                        {5, "0000012C", "B2D05E00", 300, 3e9F},
                                        {6, "FFFFFED4", "B2D05E00", -300, -1294967296.0F},
                                        {7, "BFA00000", "3F400000", -1.25F, 0.75F},
                                        {8, "BFF4000000000000", "3FE8000000000000", -1.25F, 0.75F}};
  for (const FoxgloveType& type : types) {
    SCOPED_TRACE(type.number);
    const std::string x = test::turned(hex(type.x));
    const auto size = static_cast<std::uint32_t>(x.size());
    const std::string data =
        x + test::turned(hex(type.brightness)) + little<float>(2) + little<float>(3);
    const std::string message = ProtobufBytes()
                                    .block(1, foxglove_time(1'700'000'000, 250'000'000))
                                    .block(2, "lidar")
                                    .fixed32(4, 2 * size + 8)
                                    .block(5, foxglove_field("x", 0, type.number))
                                    .block(5, foxglove_field("intensity", size, type.number))
                                    .block(5, foxglove_field("y", 2 * size, 7))
                                    .block(5, foxglove_field("z", 2 * size + 4, 7))
                                    .block(5, foxglove_field("unknown", 0, 0))
                                    .block(6, data)
                                    .bytes();
    const Scan scan = scan_of_message(message, foxglove_topic);
    EXPECT_THAT(scan.points, ElementsAre(Eigen::Vector3f(type.x_value, 2, 3)));
    EXPECT_THAT(scan.intensities, ElementsAre(type.brightness_value));
    EXPECT_EQ(scan.stamp_ns, stamp_ns);
  }
}

std::string vector_of(double x, double y, double z) {
  return ProtobufBytes().fixed64(1, x).fixed64(2, y).fixed64(3, z).bytes();
}

/// Points (1,0,0) and (0,0,2), 0.1 s apart, with a pose before them. A number that is 0 is absent.
std::string foxglove_cloud(const std::string& pose) {
  const std::string data = little<float>(1) + little<float>(0) + little<float>(0) +
                           little<std::uint32_t>(0) + little<float>(0) + little<float>(0) +
                           little<float>(2) + little<std::uint32_t>(100'000'000);
  const std::string x = ProtobufBytes().block(1, "x").varint(3, 7).bytes();
  return ProtobufBytes()
      .block(6, data)
      .block(3, pose)
      .varint(99, 1'000'000'000'000)  // of a later version
      .block(5, x)
      .block(5, foxglove_field("y", 4, 7))
      .block(5, foxglove_field("z", 8, 7))
      .block(5, foxglove_field("timestamp", 12, 5))
      .fixed32(4, 16)
      .block(1, foxglove_time(1'700'000'000, 250'000'000))
      .bytes();
}

TEST(FoxglovePointCloud, LiesWhereItsPoseSays) {
  // A quarter of a turn to the left, then (1,2,3) aside.
  const std::string turn =
      vector_of(0, 0, std::sqrt(0.5)) + ProtobufBytes().fixed64(4, std::sqrt(0.5)).bytes();
  const std::string pose = ProtobufBytes().block(1, vector_of(1, 2, 3)).block(2, turn).bytes();
  const Scan scan = scan_of_message(foxglove_cloud(pose), foxglove_topic);
  ASSERT_EQ(scan.points.size(), 2U);
  EXPECT_LT((scan.points[0] - Eigen::Vector3f(1, 3, 3)).norm(), 1e-6F);
  EXPECT_LT((scan.points[1] - Eigen::Vector3f(1, 2, 5)).norm(), 1e-6F);
  EXPECT_THAT(scan.time_offsets, ElementsAre(0.0F, 0.1F));

  const std::string no_turn = ProtobufBytes().block(1, vector_of(1, 2, 3)).bytes();
  EXPECT_THAT(scan_of_message(foxglove_cloud(no_turn), foxglove_topic).points,
              ElementsAre(Eigen::Vector3f(2, 2, 3), Eigen::Vector3f(1, 2, 5)));
  EXPECT_THAT(scan_of_message(foxglove_cloud(""), foxglove_topic).points,
              ElementsAre(Eigen::Vector3f(1, 0, 0), Eigen::Vector3f(0, 0, 2)));
  const std::string nowhere = ProtobufBytes().block(1, vector_of(NAN, 2, 3)).bytes();
  EXPECT_THROW(scan_of_message(foxglove_cloud(nowhere), foxglove_topic), Refusal);
}

TEST(FoxglovePointCloud, WithPointsThatAreNotWholeIsRefused) {
  ProtobufBytes fields;
  fields.block(5, foxglove_field("x", 0, 7)).block(5, foxglove_field("y", 4, 7));
  fields.block(5, foxglove_field("z", 8, 7));
  std::string data;
  for (const float value : {1.0F, 2.0F, 3.0F, 4.0F, 5.0F, 6.0F}) data += little<float>(value);
  const auto scan = [&](std::uint32_t stride, std::size_t bytes) {
    return scan_of_message(
        ProtobufBytes(fields).fixed32(4, stride).block(6, data.substr(0, bytes)).bytes(),
        foxglove_topic);
  };
  EXPECT_THAT(scan(12, 24).points, ElementsAre(Eigen::Vector3f(1, 2, 3), Eigen::Vector3f(4, 5, 6)));
  EXPECT_EQ(scan(12, 0).points.size(), 0U);
  EXPECT_THROW(scan(12, 23), Refusal);
  EXPECT_THROW(scan(0, 24), Refusal);
  EXPECT_THROW(scan(8, 24), Refusal);  // z would lie in the next point
}

}  // namespace
}  // namespace kissmap
