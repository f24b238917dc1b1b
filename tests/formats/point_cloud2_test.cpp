// SPDX-License-Identifier: MIT
// sensor_msgs/PointCloud2 of ROS 1 and of ROS 2 in both byte orders, against numbers whose bytes
// were worked out by hand.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>

#include "formats/clouds/refusal.hpp"
#include "formats/message_scans.hpp"
#include "formats/messages/cloud_message.hpp"

namespace kissmap {
namespace {

using test::CloudOfBytes;
using test::hex;
using test::little;
using test::plain_cloud;
using test::point_cloud2;
using test::ros_forms;
using test::RosForm;
using test::scan_of_cloud;
using testing::ElementsAre;

constexpr float nan = std::numeric_limits<float>::quiet_NaN();

// 145 bytes of another serialiser (@foxglove/rosmsg2-serialization 3.1.0) for what is described
// below.
TEST(PointCloud2, OfCdrIsReadFromTheBytesOfAnotherSerialiser) {
  const std::string message =
      hex("00010000 05000000 06000000 08000000 6C69646172 5F7800 01000000 02000000 03000000"
          "02000000 7800 0000 00000000 07 000000 01000000"
          "0A000000 696E74656E7369747900 0000 04000000 07 000000 01000000"
          "02000000 7400 0000 08000000 06 000000 01000000"
          "00 000000 0C000000 18000000 18000000"
          "000102030405060708090A0B 0C0D0E0F1011121314151617 01");
  ASSERT_EQ(message.size(), 145U);
  const CloudMessage cloud = read_point_cloud2(test::bytes_of(message), MessageEncoding::cdr);
  EXPECT_EQ(cloud.stamp_ns, 5'000'000'006);
  EXPECT_EQ(cloud.frame, "lidar_x");
  EXPECT_EQ(cloud.records.count, 2U);
  const auto& fields = cloud.records.layout.fields;
  ASSERT_EQ(fields.size(), 3U);
  EXPECT_EQ(fields[1].name, "intensity");
  EXPECT_EQ(fields[1].offset, 4U);
  EXPECT_EQ(fields[1].type, ScalarType::f32);
  EXPECT_EQ(fields[2].name, "t");
  EXPECT_EQ(fields[2].offset, 8U);
  EXPECT_EQ(fields[2].type, ScalarType::u32);
  EXPECT_EQ(fields[2].stride, 12U);
  ASSERT_EQ(cloud.records.bytes.size(), 24U);
  EXPECT_EQ(cloud.records.bytes[0], std::byte{0x00});
  EXPECT_EQ(cloud.records.bytes[23], std::byte{0x17});

  // The messages of all other tests are written by the same rules.
  CloudOfBytes same;
  same.seconds = 5;
  same.nanoseconds = 6;
  same.frame = "lidar_x";
  same.width = 2;
  same.fields = {{"x", 0, 7}, {"intensity", 4, 7}, {"t", 8, 6}};
  same.point_step = 12;
  same.row_step = 24;
  for (char i = 0; i < 24; ++i) same.data += i;
  std::string written = point_cloud2(RosForm::cdr_little, same);
  written.back() = '\1';  // is_dense
  EXPECT_EQ(written, message);
}

/// Numbers of one datatype, the byte with the highest value first.
struct Datatype {
  std::uint8_t code;
  const char* x;
  const char* y;
  const char* z;
  const char* intensity;
  Eigen::Vector3f point;
  float brightness;
  const char* first_time;
  const char* second_time;
  std::vector<float> times;  ///< s after 1700000000.25; none: too narrow for a time
};

// Brightness has its highest bit set: that tells signed numbers from others.
const std::vector<Datatype> datatypes{
    {1, "FD", "04", "7F", "C8", {-3, 4, 127}, -56, "00", "05", {}},
    {2, "03", "04", "C8", "C8", {3, 4, 200}, 200, "00", "05", {}},
    {3, "FED4", "0004", "03E8", "9C40", {-300, 4, 1000}, -25536, "0000", "0005", {}},
    {4, "012C", "0004", "2328", "9C40", {300, 4, 9000}, 40000, "0000", "0005", {}},
    {5,
     "FFFFFED4",
     "00000004",
     "000003E8",
     "B2D05E00",
     {-300, 4, 1000},
     -1294967296.0F,
     "FD050F80",
     "02FAF080",
     {-0.05F, 0.05F}},  // ns
    {6,
     "0000012C",
     "00000004",
     "00002328",
     "B2D05E00",
     {300, 4, 9000},
     3e9F,
     "00000000",
     "05F5E100",
     {0.0F, 0.1F}},  // ns
    {7,
     "3F000000",
     "BFA00000",
     "40000000",
     "BF400000",
     {0.5F, -1.25F, 2},
     -0.75F,
     "BE000000",
     "00000000",
     {-0.125F, 0.0F}},  // s
    {8,
     "3FE0000000000000",
     "BFF4000000000000",
     "4000000000000000",
     "BFE8000000000000",
     {0.5F, -1.25F, 2},
     -0.75F,
     "41D954FC40080000",
     "41D954FC40100000",
     {-0.125F, 0.0F}}};  // s since 1970

// Two rows of one point each; three bytes of other things before the fields, five behind each row.
CloudOfBytes cloud_of(const Datatype& type, bool big_endian) {
  const auto number = [&](const char* digits) {
    return big_endian ? hex(digits) : test::turned(hex(digits));
  };
  const auto size = static_cast<std::uint32_t>(hex(type.x).size());
  CloudOfBytes cloud;
  cloud.nanoseconds = 250'000'000;
  cloud.height = 2;
  cloud.width = 1;
  std::uint32_t offset = 3;
  for (const char* name : {"z", "t", "x", "intensity", "y"}) {
    cloud.fields.push_back({name, offset, type.code});
    offset += size;
  }
  cloud.big_endian = big_endian;
  cloud.point_step = offset;
  cloud.row_step = offset + 5;
  for (const char* time : {type.first_time, type.second_time}) {
    cloud.data += "???" + number(type.z) + number(time) + number(type.x) + number(type.intensity) +
                  number(type.y) + "?????";
  }
  return cloud;
}

TEST(PointCloud2, OfEveryDatatypeByteOrderAndEncoding) {
  for (const Datatype& type : datatypes) {
    for (const bool big_endian : {false, true}) {
      for (const RosForm form : ros_forms) {
        SCOPED_TRACE(std::to_string(type.code) + (big_endian ? " big endian, form " : ", form ") +
                     std::to_string(static_cast<int>(form)));
        const Scan scan = scan_of_cloud(form, cloud_of(type, big_endian));
        EXPECT_THAT(scan.points, ElementsAre(type.point, type.point));
        EXPECT_THAT(scan.intensities, ElementsAre(type.brightness, type.brightness));
        EXPECT_THAT(scan.time_offsets, testing::ElementsAreArray(type.times));
        EXPECT_EQ(scan.time_source, type.times.empty() ? TimeSource::none : TimeSource::recorded);
        EXPECT_EQ(scan.stamp_ns, 1'700'000'000'250'000'000);
      }
    }
  }
}

TEST(PointCloud2, RowsMayBePaddedButTheLastAndBeOfUnknownLength) {
  CloudOfBytes cloud = plain_cloud({{1, 2, 3}, {4, 5, 6}, {7, 8, 9}, {10, 11, 12}});
  cloud.height = 2;
  cloud.width = 2;
  const std::string rows = cloud.data;
  const auto expect_all = [&] {
    for (const RosForm form : ros_forms) {
      EXPECT_THAT(scan_of_cloud(form, cloud).points,
                  ElementsAre(Eigen::Vector3f(1, 2, 3),
                              Eigen::Vector3f(4, 5, 6),
                              Eigen::Vector3f(7, 8, 9),
                              Eigen::Vector3f(10, 11, 12)));
    }
  };
  cloud.row_step = 31;
  cloud.data = rows.substr(0, 24) + "padding" + rows.substr(24);
  expect_all();
  cloud.data += "padding";
  expect_all();
  cloud.row_step = 0;  // some writers leave it empty
  cloud.data = rows;
  expect_all();
  cloud.row_step = 24;
  cloud.data.pop_back();
  EXPECT_THROW(scan_of_cloud(RosForm::ros1, cloud), Refusal);
}

TEST(PointCloud2, WhatIsNoReturnGoesWithItsTimeAndIntensity) {
  CloudOfBytes cloud;
  cloud.height = 2;  // organised: a point for each shot, whether it came back or not
  cloud.width = 3;
  cloud.fields = {{"x", 0}, {"y", 4}, {"z", 8}, {"intensity", 12}, {"t", 16, 6}};
  cloud.point_step = 20;
  cloud.row_step = 60;
  const auto add = [&](float x, float y, float z, float intensity, std::uint32_t t) {
    cloud.data += little<float>(x) + little<float>(y) + little<float>(z) +
                  little<float>(intensity) + little<std::uint32_t>(t);
  };
  add(nan, nan, nan, 1, 0);
  add(1, 2, 3, 2, 20'000'000);
  add(0, 0, 0, 3, 40'000'000);
  add(4, nan, 6, 4, 60'000'000);
  add(7, 8, 9, 5, 80'000'000);
  add(0, 0, std::numeric_limits<float>::infinity(), 6, 100'000'000);
  for (const RosForm form : ros_forms) {
    const Scan scan = scan_of_cloud(form, cloud);
    EXPECT_THAT(scan.points, ElementsAre(Eigen::Vector3f(1, 2, 3), Eigen::Vector3f(7, 8, 9)));
    EXPECT_THAT(scan.intensities, ElementsAre(2, 5));
    EXPECT_THAT(scan.time_offsets, ElementsAre(0.02F, 0.08F));
    EXPECT_EQ(scan.dropped, (DroppedReturns{3, 1, 0}));
  }
}

TEST(PointCloud2, WithoutPointsIsAScanWithout) {
  CloudOfBytes cloud = plain_cloud({});
  for (const RosForm form : ros_forms) {
    EXPECT_EQ(scan_of_cloud(form, cloud).points.size(), 0U);
    cloud.height = 0;
    EXPECT_EQ(scan_of_cloud(form, cloud).points.size(), 0U);
    cloud.height = 1;
  }
}

TEST(PointCloud2, FieldsOfSeveralValuesOrUnknownTypesArePassedOver) {
  CloudOfBytes cloud = plain_cloud({{1, 2, 3}});
  cloud.fields = {{"normal", 0, 7, 3}, {"odd", 12, 0}, {"x", 16}, {"y", 20}, {"z", 24, 7, 0}};
  cloud.point_step = 28;
  cloud.data = std::string(16, '?') + cloud.data;
  for (const RosForm form : ros_forms) {
    EXPECT_THAT(scan_of_cloud(form, cloud).points, ElementsAre(Eigen::Vector3f(1, 2, 3)));
  }
}

TEST(PointCloud2, WithoutAStampIsAtTheTimeOfRecording) {
  CloudOfBytes cloud = plain_cloud({{1, 2, 3}});
  cloud.seconds = 0;
  EXPECT_EQ(scan_of_cloud(RosForm::cdr_little, cloud).stamp_ns, test::received_ns);
}

// All but is_dense, the last byte, tells something.
TEST(PointCloud2, CutAnywhereIsRefused) {
  for (const RosForm form : ros_forms) {
    const std::string whole = point_cloud2(form, plain_cloud({{1, 2, 3}, {4, 5, 6}}));
    const Topic topic = test::topic_of(form, "sensor_msgs/PointCloud2");
    for (std::size_t size = 0; size + 1 < whole.size(); ++size) {
      EXPECT_THROW(test::scan_of_message(whole.substr(0, size), topic), Refusal) << size;
    }
  }
}

TEST(PointCloud2, OfAnotherEncapsulationIsRefusedByItsNumber) {
  std::string message = point_cloud2(RosForm::cdr_little, plain_cloud({{1, 2, 3}}));
  for (const int kind : {2, 3, 6, 7, 8, 9, 10, 11}) {
    message[1] = static_cast<char>(kind);
    try {
      read_point_cloud2(test::bytes_of(message), MessageEncoding::cdr);
      ADD_FAILURE() << kind;
    } catch (const Refusal& refusal) {
      EXPECT_STREQ(refusal.reason(), refusal_reason::unsupported);
      EXPECT_THAT(refusal.what(), testing::HasSubstr("kind " + std::to_string(kind)));
    }
  }
}

}  // namespace
}  // namespace kissmap
