// SPDX-License-Identifier: MIT
// The format that examples/add_a_format makes up.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "add_a_format/polar_log.hpp"
#include "formats/support.hpp"

namespace kissmap {
namespace {

using test::Bytes;
using test::read_all;
using test::TempDir;

std::string polar_scan() {
  const auto record = [](unsigned azimuth, int elevation, unsigned range, std::uint32_t us) {
    return Bytes()
        .add<std::uint16_t>(static_cast<std::uint16_t>(azimuth))
        .add<std::int16_t>(static_cast<std::int16_t>(elevation))
        .add<std::uint16_t>(static_cast<std::uint16_t>(range))
        .add<std::uint16_t>(77)
        .add<std::uint32_t>(us)
        .text();
  };
  std::string text = "POLAR1" + record(0, 0, 2000, 0) + record(9000, 0, 2000, 25'000);
  text += record(4500, 0, 0, 30'000);  // no return
  for (unsigned i = 0; i < 100; ++i) text += record(i * 100, 3000, 4000, 50'000 + i);
  return text;
}

TEST(ExampleFormat, IsReadAsItSays) {
  const TempDir dir;
  dir.write("1700000000100000.polar", polar_scan());
  dir.write("1700000000200000.polar", polar_scan().substr(0, 100));
  dir.write("1700000000300000.polar", "no polar");
  ASSERT_TRUE(probe_polar(dir.path()));
  const auto entries = read_all(*open_polar(dir.path(), {}));
  ASSERT_EQ(entries.size(), 3U);
  const Scan& scan = test::scan_of(entries[0]);
  EXPECT_EQ(scan.stamp_ns, 1'700'000'000'100'000'000);
  ASSERT_EQ(scan.points.size(), 102U);
  EXPECT_EQ(scan.dropped.zero, 1U);
  EXPECT_NEAR((scan.points[0] - Eigen::Vector3f(10, 0, 0)).norm(), 0.0F, 1e-5F);
  EXPECT_NEAR((scan.points[1] - Eigen::Vector3f(0, 10, 0)).norm(), 0.0F, 1e-5F);
  EXPECT_NEAR(scan.points[2].z(), 10.0F, 1e-5F);
  EXPECT_NEAR(scan.time_offsets[1], 0.025F, 1e-7F);
  EXPECT_EQ(scan.intensities[1], 77.0F);
  EXPECT_EQ(test::refusal_of(entries[1]).reason, "truncated file");
  EXPECT_EQ(test::refusal_of(entries[2]).reason, "not what its name says");
  EXPECT_FALSE(probe_polar(dir.path() / "none"));
}

}  // namespace
}  // namespace kissmap
