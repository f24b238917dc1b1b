// SPDX-License-Identifier: MIT
// Times of points as drivers write them into sensor_msgs/PointCloud2, from bytes made by hand.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "formats/message_scans.hpp"

namespace kissmap {
namespace {

using test::CloudOfBytes;
using test::little;
using test::ros_forms;
using test::RosForm;
using test::scan_of_cloud;
using testing::FloatNear;
using testing::Pointwise;

constexpr std::int64_t stamp_ns = 1'700'000'000'250'000'000;

/// Five points (k + 1, 2, 3) at times, since `since`, of a driver's own kind.
template <class T>
CloudOfBytes cloud_of_driver(const std::vector<test::FieldOfCloud>& after_xyz,
                             std::uint32_t point_step,
                             const std::vector<T>& times,
                             T since = 0) {
  CloudOfBytes cloud;
  cloud.nanoseconds = 250'000'000;
  cloud.fields = {{"x", 0}, {"y", 4}, {"z", 8}};
  cloud.fields.insert(cloud.fields.end(), after_xyz.begin(), after_xyz.end());
  cloud.width = static_cast<std::uint32_t>(times.size());
  cloud.point_step = point_step;
  cloud.row_step = point_step * cloud.width;
  for (std::size_t k = 0; k < times.size(); ++k) {
    std::string point =
        little<float>(static_cast<float>(k + 1)) + little<float>(2) + little<float>(3);
    point.resize(point_step, '\x77');
    cloud.data += point.replace(after_xyz.back().offset, sizeof(T), little<T>(since + times[k]));
  }
  return cloud;
}

void expect_times(const CloudOfBytes& cloud,
                  const std::vector<float>& expected,
                  StampInstant instant,
                  float tolerance) {
  for (const RosForm form : ros_forms) {
    const Scan scan = scan_of_cloud(form, cloud);
    EXPECT_EQ(scan.stamp_ns, stamp_ns);
    EXPECT_EQ(scan.points.back(), Eigen::Vector3f(5, 2, 3));
    EXPECT_THAT(scan.time_offsets, Pointwise(FloatNear(tolerance), expected));
    EXPECT_EQ(scan.stamp_instant, instant);
    EXPECT_EQ(scan.time_source, TimeSource::recorded);
  }
}

// The stamp is that of the last packet. 22 bytes a point, the time where no float would be aligned.
TEST(DriverTimes, OfVelodyneAreNegativeSeconds) {
  const std::vector<float> times = {-0.1F, -0.075F, -0.05F, -0.025F, 0.0F};
  expect_times(cloud_of_driver({{"intensity", 12}, {"ring", 16, 4}, {"time", 18, 7}}, 22, times),
               times,
               StampInstant::sweep_end,
               1e-8F);
}

TEST(DriverTimes, OfOusterAreNanosecondsSinceTheStamp) {
  const std::vector<std::uint32_t> ns = {0, 25'000'000, 50'000'000, 75'000'000, 99'900'000};
  expect_times(cloud_of_driver({{"intensity", 16}, {"t", 20, 6}}, 48, ns),
               {0.0F, 0.025F, 0.05F, 0.075F, 0.0999F},
               StampInstant::sweep_start,
               1e-8F);
}

// A double tells seconds since 1970 to 0.24 us.
CloudOfBytes cloud_of_seconds_since_1970(const std::vector<double>& seconds) {
  return cloud_of_driver(
      {{"intensity", 12}, {"ring", 16, 4}, {"timestamp", 18, 8}}, 26, seconds, 1'700'000'000.0);
}

TEST(DriverTimes, OfHesaiAreSecondsSince1970WhereNoDoubleWouldBeAligned) {
  expect_times(cloud_of_seconds_since_1970({0.25, 0.275, 0.3, 0.325, 0.35}),
               {0.0F, 0.025F, 0.05F, 0.075F, 0.1F},
               StampInstant::sweep_start,
               3e-7F);
}

// RoboSense may stamp a cloud by its last point.
TEST(DriverTimes, OfRobosenseMayEndAtTheStamp) {
  expect_times(cloud_of_seconds_since_1970({0.15, 0.175, 0.2, 0.225, 0.25}),
               {-0.1F, -0.075F, -0.05F, -0.025F, 0.0F},
               StampInstant::sweep_end,
               3e-7F);
}

// Nanoseconds since 1970 in a double, which holds every 256th of them; so are these.
TEST(DriverTimes, OfLivoxAreNanosecondsSince1970InADouble) {
  const std::vector<double> ns = {0.0, 25'600'000.0, 51'200'000.0, 76'800'000.0, 102'400'000.0};
  expect_times(cloud_of_driver({{"intensity", 12}, {"line", 17, 2}, {"timestamp", 18, 8}},
                               26,
                               ns,
                               1'700'000'000'249'999'872.0),
               {-128e-9F, 0.025599872F, 0.051199872F, 0.076799872F, 0.102399872F},
               StampInstant::sweep_start,
               1e-8F);
}

TEST(DriverTimes, OfAevaAreSignedNanoseconds) {
  const std::vector<std::int32_t> ns = {-50'000'000, -25'000'000, 0, 25'000'000, 50'000'000};
  expect_times(cloud_of_driver({{"reflectivity", 12}, {"time_offset_ns", 20, 5}}, 25, ns),
               {-0.05F, -0.025F, 0.0F, 0.025F, 0.05F},
               StampInstant::sweep_middle,
               1e-8F);
}

}  // namespace
}  // namespace kissmap
