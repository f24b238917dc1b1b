// SPDX-License-Identifier: MIT
#include "formats/text/stamps.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <string>
#include <vector>

namespace kissmap {
namespace {

using testing::Optional;

TEST(Seconds, AreExactToTheNanosecond) {
  EXPECT_THAT(nanoseconds_from_seconds("1577836980.0991046"), Optional(1577836980099104600));
  EXPECT_THAT(nanoseconds_from_seconds("1700000000.123456789"), Optional(1700000000123456789));
  EXPECT_THAT(nanoseconds_from_seconds("0.0000000005"), Optional(1));
  EXPECT_THAT(nanoseconds_from_seconds("0.00000000049"), Optional(0));
  EXPECT_THAT(nanoseconds_from_seconds("9223372036.854775807"), Optional(9223372036854775807));
}

TEST(Seconds, MayHaveSignsAndExponents) {
  EXPECT_THAT(nanoseconds_from_seconds("1.036224e-01"), Optional(103622400));
  EXPECT_THAT(nanoseconds_from_seconds("0.000000e+00"), Optional(0));
  EXPECT_THAT(nanoseconds_from_seconds("4.707838e+02"), Optional(470783800000));
  EXPECT_THAT(nanoseconds_from_seconds("-0.25"), Optional(-250000000));
  EXPECT_THAT(nanoseconds_from_seconds("+3."), Optional(3000000000));
  EXPECT_THAT(nanoseconds_from_seconds("1e-400"), Optional(0));
}

TEST(Seconds, RefuseWhatIsNoNumberOrDoesNotFit) {
  for (const char* text : {"",
                           "-",
                           ".",
                           "1.2.3",
                           "1,5",
                           "nan",
                           "inf",
                           "0x10",
                           "1e",
                           "1e999",
                           "1e99999999999999999999",
                           "12 3",
                           "9223372036.854775808",
                           "1e-9999",
                           "--1",
                           "9999999999999999999"}) {
    EXPECT_EQ(nanoseconds_from_seconds(text), std::nullopt) << text;
  }
}

TEST(Digits, TellTheirUnit) {
  EXPECT_THAT(nanoseconds_from_digits("1600000000"), Optional(1600000000000000000));
  EXPECT_THAT(nanoseconds_from_digits("1600000000123"), Optional(1600000000123000000));
  EXPECT_THAT(nanoseconds_from_digits("1600000000123456"), Optional(1600000000123456000));
  EXPECT_THAT(nanoseconds_from_digits("1600000000123456789"), Optional(1600000000123456789));
  for (const char* text : {"0000000005", "000133", "160000000012", "9999999999999999999", ""}) {
    EXPECT_EQ(nanoseconds_from_digits(text), std::nullopt) << text;
  }
}

// Newer College 2020 writes nanoseconds without leading zeros (trap 9).
TEST(Names, HoldSecondsAndUnpaddedNanoseconds) {
  EXPECT_THAT(stamp_in_name("cloud_1583836591_5"), Optional(1583836591000000005));
  EXPECT_THAT(stamp_in_name("cloud_1583836591_182590976"), Optional(1583836591182590976));
  EXPECT_LT(stamp_in_name("cloud_1583836591_5"), stamp_in_name("cloud_1583836591_182590976"));
}

TEST(Names, HoldStampsInSeveralWays) {
  EXPECT_THAT(stamp_in_name("1630577758_569489956"), Optional(1630577758569489956));
  EXPECT_THAT(stamp_in_name("1630577758.5"), Optional(1630577758500000000));
  EXPECT_THAT(stamp_in_name("pc.1630577758.25"), Optional(1630577758250000000));
  EXPECT_THAT(stamp_in_name("12_050000000"), Optional(12050000000));
  EXPECT_THAT(stamp_in_name("1606417097528152"), Optional(1606417097528152000));
  EXPECT_THAT(stamp_in_name("frame-1600000000123"), Optional(1600000000123000000));
}

TEST(Names, OfCountersAreNoStamps) {
  for (const char* stem : {"000133",
                           "0000000005",
                           "frame_00012",
                           "07_000123",
                           "scan",
                           "",
                           "cloud_1583836591_5 (1)",
                           "9999999999_1",
                           "_",
                           "."}) {
    EXPECT_EQ(stamp_in_name(stem), std::nullopt) << stem;
  }
}

TEST(Dates, AreReadAsUtc) {
  EXPECT_THAT(nanoseconds_from_date("1970-01-01 00:00:00"), Optional(0));
  EXPECT_THAT(nanoseconds_from_date("2011-09-26 13:02:25.964389445"),
              Optional(1317042145964389445));
  EXPECT_THAT(nanoseconds_from_date("2012-02-29 23:59:59.5"), Optional(1330559999500000000));
  for (const char* text : {"2011-02-29 00:00:00",
                           "2011-09-26",
                           "2011-09-26T13:02:25.9",
                           "2011-09-26 24:00:00",
                           "2011-09-26 13:02:25,9",
                           "2011-09-26 13:02:25.9E1",  // nine seconds, no fraction
                           "2058-03-01 22:08:06.9E10",
                           "9999-01-01 00:00:00"}) {
    EXPECT_EQ(nanoseconds_from_date(text), std::nullopt) << text;
  }
}

// Apollo counts from 1 without leading zeros (trap 10).
TEST(NaturalOrder, ComparesNumbersByValue) {
  std::vector<std::string> names;
  for (int i = 1; i <= 120; ++i) names.push_back(std::to_string(i) + ".pcd");
  std::vector<std::string> shuffled = names;
  std::shuffle(shuffled.begin(), shuffled.end(), std::mt19937(1));
  std::ranges::sort(shuffled, natural_less);
  EXPECT_EQ(shuffled, names);
}

TEST(NaturalOrder, IsStrictAndTotal) {
  const std::vector<std::string> names = {"",    "0",   "00",  "1",    "01",    "a",     "a0",
                                          "a00", "a1",  "a01", "a1b",  "a01b",  "a10",   "b",
                                          "a2",  "a-1", "a 1", "1a2b", "1a10b", "01a2b", "1a02b"};
  for (const auto& a : names) {
    for (const auto& b : names) {
      EXPECT_EQ(natural_less(a, b) + natural_less(b, a), a == b ? 0 : 1) << a << " " << b;
      for (const auto& c : names) {
        if (natural_less(a, b) && natural_less(b, c)) {
          EXPECT_TRUE(natural_less(a, c)) << a << " " << b << " " << c;
        }
      }
    }
  }
}

}  // namespace
}  // namespace kissmap
