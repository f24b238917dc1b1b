// SPDX-License-Identifier: MIT
#include "kissmap/cloud/scan.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "kissmap/error.hpp"

namespace kissmap {
namespace {

Scan good_scan() {
  Scan scan;
  scan.points = {{1, 2, 3}, {4, 5, 6}};
  scan.time_source = TimeSource::recorded;
  scan.time_offsets = {-0.05F, 0.02F};
  scan.intensities = {1, 2};
  return scan;
}

TEST(Scan, ConsistentOnesPass) {
  EXPECT_NO_THROW(require_consistent(good_scan()));
  EXPECT_NO_THROW(require_consistent(Scan{}));
}

TEST(Scan, EachBrokenInvariantIsFound) {
  const std::vector<std::function<void(Scan&)>> damages{
      [](Scan& s) { s.time_offsets.pop_back(); },
      [](Scan& s) { s.intensities.push_back(3); },
      [](Scan& s) { s.time_source = TimeSource::none; },
      [](Scan& s) { s.time_offsets.clear(); },
      [](Scan& s) { s.time_offsets[1] = std::nanf(""); },
      [](Scan& s) { s.points[0].y() = INFINITY; },
      [](Scan& s) { s.points[1].setZero(); },
      [](Scan& s) { s.points[1].x() = 2.0F * max_plausible_range; },
      [](Scan& s) { s.no_return_time_offsets = {0.0F}; },
  };
  for (std::size_t i = 0; i < damages.size(); ++i) {
    Scan scan = good_scan();
    damages[i](scan);
    EXPECT_THROW(require_consistent(scan), Error) << "damage " << i;
  }
}

TEST(Scan, TimeSpanIsThatOfThePoints) {
  const auto span = time_span(good_scan());
  ASSERT_TRUE(span);
  EXPECT_EQ(span->first, -0.05F);
  EXPECT_EQ(span->last, 0.02F);
  EXPECT_FALSE(time_span(Scan{}));
}

}  // namespace
}  // namespace kissmap
