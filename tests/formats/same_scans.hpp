// SPDX-License-Identifier: MIT
#pragma once

#include <gtest/gtest.h>

#include <vector>

#include "kissmap/formats/scan_log.hpp"

namespace kissmap::test {

/// To the last bit.
inline void expect_same(const Scan& scan, const Scan& expected) {
  EXPECT_EQ(scan.stamp_ns, expected.stamp_ns);
  EXPECT_EQ(scan.stamp_is_index, expected.stamp_is_index);
  EXPECT_EQ(scan.stamp_instant, expected.stamp_instant);
  EXPECT_EQ(scan.compensation, expected.compensation);
  EXPECT_EQ(scan.time_source, expected.time_source);
  EXPECT_TRUE(scan.points == expected.points);
  EXPECT_TRUE(scan.time_offsets == expected.time_offsets);
  EXPECT_TRUE(scan.intensities == expected.intensities);
  EXPECT_TRUE(scan.no_return_directions == expected.no_return_directions);
  EXPECT_TRUE(scan.no_return_time_offsets == expected.no_return_time_offsets);
  EXPECT_EQ(scan.dropped, expected.dropped);
}

inline void expect_same(const LogEntry& entry, const LogEntry& expected) {
  EXPECT_EQ(entry.index, expected.index);
  EXPECT_EQ(entry.name, expected.name);
  ASSERT_EQ(entry.content.index(), expected.content.index());
  if (const auto* refused = std::get_if<RefusedScan>(&expected.content)) {
    EXPECT_EQ(std::get<RefusedScan>(entry.content).reason, refused->reason);
    EXPECT_EQ(std::get<RefusedScan>(entry.content).detail, refused->detail);
  } else {
    expect_same(std::get<Scan>(entry.content), std::get<Scan>(expected.content));
  }
}

}  // namespace kissmap::test
