// SPDX-License-Identifier: MIT
#include "formats/clouds/time_rule.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace kissmap {
namespace {

constexpr std::int64_t stamp_ns = 1'700'000'000'250'000'000;
constexpr int points = 1000;
constexpr double nan = std::numeric_limits<double>::quiet_NaN();

/// A sweep of 0.1 s whose times are `zero` + i * 1e-4 s, written in units of `unit` seconds.
RawTimes sweep(ScalarType type, double zero, double unit) {
  RawTimes times{type, 0, {}};
  for (int i = 0; i < points; ++i) times.values.push_back((zero + i * 1e-4) / unit);
  return times;
}

struct Case {
  const char* driver;
  ScalarType type;
  double zero;  ///< s
  double unit;  ///< s
  TimeReading reading;
};

class TimeRule : public testing::TestWithParam<Case> {};

TEST_P(TimeRule, FindsUnitAndZero) {
  const Case& c = GetParam();
  const RawTimes times = sweep(c.type, c.zero, c.unit);
  const auto reading = find_time_reading(times, "");
  ASSERT_TRUE(reading) << c.driver;
  EXPECT_EQ(*reading, c.reading) << c.driver << ": " << describe(*reading);
  const auto result = times_from_stamp(times, *reading, stamp_ns);
  ASSERT_TRUE(result);
  EXPECT_NEAR(result->offsets.back() - result->offsets.front(), (points - 1) * 1e-4, 1e-6);
}

constexpr double epoch = 1'700'000'000.25;
using enum TimeUnit;

INSTANTIATE_TEST_SUITE_P(
    Drivers,
    TimeRule,
    testing::Values(Case{"ouster t", ScalarType::u32, 0.0, 1e-9, {nanoseconds, false}},
                    Case{"velodyne time", ScalarType::f32, -0.1, 1.0, {seconds, false}},
                    Case{"boreas time", ScalarType::f32, -0.05, 1.0, {seconds, false}},
                    Case{"hesai timestamp", ScalarType::f64, epoch, 1.0, {seconds, true}},
                    Case{"livox timestamp", ScalarType::f64, epoch, 1e-9, {nanoseconds, true}},
                    Case{"float us", ScalarType::f64, epoch, 1e-6, {microseconds, true}},
                    Case{"float ms", ScalarType::f64, epoch, 1e-3, {milliseconds, true}},
                    Case{"relative ms", ScalarType::f32, 0.0, 1e-3, {milliseconds, false}},
                    Case{"relative us", ScalarType::f32, 0.0, 1e-6, {microseconds, false}},
                    Case{"relative ns", ScalarType::f64, 0.0, 1e-9, {nanoseconds, false}},
                    Case{
                        "relative ns from 0.5 s", ScalarType::f64, 0.5, 1e-9, {nanoseconds, false}},
                    Case{"aeva offset", ScalarType::i32, 0.0, 1e-9, {nanoseconds, false}},
                    Case{"u64 ns", ScalarType::u64, epoch, 1e-9, {nanoseconds, true}},
                    Case{"u64 us", ScalarType::u64, epoch, 1e-6, {microseconds, true}},
                    Case{"u64 ns relative", ScalarType::u64, 0.0, 1e-9, {nanoseconds, false}},
                    Case{"u64 us since boot", ScalarType::u64, 500.0, 1e-6, {microseconds, false}}),
    [](const auto& test) {
      std::string name = test.param.driver;
      for (char& c : name) c = std::isalnum(static_cast<unsigned char>(c)) ? c : '_';
      return name;
    });

TEST(TimesFromStamp, PutAbsoluteTimesRelativeToTheStamp) {
  // Whole milliseconds survive a double; the stamp's own digits must not be lost in one.
  const RawTimes times{ScalarType::f64, 0, {epoch - 0.05, epoch, epoch + 0.05}};
  const auto result = times_from_stamp(times, {seconds, true}, stamp_ns);
  ASSERT_TRUE(result);
  EXPECT_THAT(result->offsets, testing::Pointwise(testing::FloatNear(3e-7F), {-0.05F, 0.F, 0.05F}));
  EXPECT_EQ(result->stamp_instant, StampInstant::sweep_middle);
  EXPECT_FALSE(result->from_first_point);
}

TEST(TimesFromStamp, KeepEveryDigitOfIntegers) {
  const RawTimes times{ScalarType::u64, stamp_ns + 12'345, {0.0, 1.0, 99'999'999.0}};
  const auto result = times_from_stamp(times, {nanoseconds, true}, stamp_ns);
  ASSERT_TRUE(result);
  EXPECT_FLOAT_EQ(result->offsets[0], 12'345e-9F);
  EXPECT_FLOAT_EQ(result->offsets[1], 12'346e-9F);
}

TEST(TimesFromStamp, StartAtTheFirstPointWhereClocksDiffer) {
  const RawTimes times = sweep(ScalarType::f64, epoch + 3600.0, 1.0);
  const auto result = times_from_stamp(times, {seconds, true}, stamp_ns);
  ASSERT_TRUE(result);
  EXPECT_TRUE(result->from_first_point);
  EXPECT_EQ(result->offsets.front(), 0.0F);
  EXPECT_EQ(result->stamp_instant, StampInstant::sweep_start);
}

TEST(TimesFromStamp, StartAtTheFirstPointOfAClockSinceBoot) {
  const RawTimes times = sweep(ScalarType::f32, 812.0, 1.0);
  const auto result = times_from_stamp(times, {seconds, false}, stamp_ns);
  ASSERT_TRUE(result);
  EXPECT_TRUE(result->from_first_point);
  EXPECT_NEAR(result->offsets.back(), 0.0999, 1e-4);
}

TEST(TimesFromStamp, SayWhichInstantTheStampIs) {
  const auto instant = [](double zero) {
    return times_from_stamp(sweep(ScalarType::f32, zero, 1.0), {seconds, false}, 0)->stamp_instant;
  };
  EXPECT_EQ(instant(0.0), StampInstant::sweep_start);
  EXPECT_EQ(instant(-0.05), StampInstant::sweep_middle);
  EXPECT_EQ(instant(-0.1), StampInstant::sweep_end);
  EXPECT_EQ(instant(0.3), StampInstant::unknown);
}

TEST(TimesFromStamp, RefuseSpansThatAreNoSweep) {
  const RawTimes equal{ScalarType::f32, 0, {0.1, 0.1}};
  EXPECT_FALSE(find_time_reading(equal, ""));
  EXPECT_FALSE(times_from_stamp(equal, {seconds, false}, 0));
  const RawTimes long_span{ScalarType::u32, 0, {0.0, 2.1e9}};
  EXPECT_FALSE(times_from_stamp(long_span, {nanoseconds, false}, 0));
  EXPECT_FALSE(times_from_stamp({ScalarType::f32, 0, {}}, {seconds, false}, 0));
}

TEST(TimesFromStamp, PassOverTimesThatAreNotFinite) {
  const RawTimes times{ScalarType::f64, 0, {nan, 0.0, 0.05, 0.1, INFINITY}};
  EXPECT_EQ(find_time_reading(times, ""), (TimeReading{seconds, false}));
  const auto result = times_from_stamp(times, {seconds, false}, 0);
  ASSERT_TRUE(result);
  EXPECT_TRUE(std::isnan(result->offsets[0]));
  EXPECT_FLOAT_EQ(result->offsets[3], 0.1F);
  EXPECT_FALSE(find_time_reading({ScalarType::f64, 0, {nan, nan}}, ""));
}

TEST(TimesFromStamp, SurviveAnyNumber) {
  for (const double huge : {1e300, -1e300, 9.3e18, -9.3e18, 1e18}) {
    const RawTimes times{ScalarType::f64, 0, {huge, huge + std::abs(huge) * 1e-15}};
    for (const TimeUnit unit : {seconds, nanoseconds}) {
      for (const bool absolute : {false, true}) {
        const auto result = times_from_stamp(times, {unit, absolute}, stamp_ns);
        EXPECT_TRUE(!result || std::isfinite(result->offsets[1])) << huge;
      }
    }
  }
}

TEST(TimeUnitOption, OverrulesTheSpan) {
  const RawTimes times = sweep(ScalarType::u32, 0.0, 1e-6);
  EXPECT_EQ(find_time_reading(times, "us"), (TimeReading{microseconds, false}));
  const RawTimes absolute = sweep(ScalarType::f64, epoch, 1e-3);
  EXPECT_EQ(find_time_reading(absolute, "ms"), (TimeReading{milliseconds, true}));
}

}  // namespace
}  // namespace kissmap
