// SPDX-License-Identifier: MIT
#include "formats/sensors/sweep_builder.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace kissmap {
namespace {

constexpr std::int64_t column_ns = 100'000;  // 0.36 degrees at ten turns a second
constexpr std::int64_t start_ns = 1'700'000'000'000'000'000;
constexpr double deg_per_column = 0.36;

class Sweeps : public testing::Test {
 protected:
  /// One return in a column begun `columns` after the start.
  void column(double columns, double azimuth_deg) {
    at_ns(start_ns + std::llround(columns * column_ns), azimuth_deg);
  }
  void at_ns(std::int64_t time_ns, double azimuth_deg) {
    builder_.begin_column(azimuth_deg, time_ns, start_ns, 1);
    builder_.add({1.0F, 2.0F, 3.0F}, 4.0F, time_ns);
  }
  void turning(int from, int to, double first_deg = 0.0) {
    for (int i = from; i < to; ++i) {
      column(i, std::fmod(first_deg + i * deg_per_column + 3600.0, 360.0));
    }
  }
  std::vector<std::size_t> sizes() {
    builder_.finish();
    std::vector<std::size_t> counts;
    for (const Scan& sweep : sweeps_) {
      EXPECT_NO_THROW(require_consistent(sweep));
      counts.push_back(sweep.points.size());
    }
    return counts;
  }

  std::deque<Scan> sweeps_;
  SweepBuilder builder_{sweeps_};
};

using Sizes = std::vector<std::size_t>;

TEST_F(Sweeps, EndWhereTheyBegan) {
  turning(0, 2500, 123.4);
  EXPECT_EQ(sizes(), (Sizes{1000, 1000, 500}));
  EXPECT_EQ(sweeps_[1].stamp_ns, start_ns + 1000 * column_ns);
  EXPECT_FLOAT_EQ(time_span(sweeps_[1])->last, 0.0999F);
}

TEST_F(Sweeps, DoNotWanderWhenColumnsDoNotDivideTheTurn) {
  for (int i = 0; i < 50'000; ++i) column(i, std::fmod(i * 0.77, 360.0));
  const Sizes counts = sizes();
  ASSERT_EQ(counts.size(), 107U);  // 50000 columns of 0.77 degrees are 106.9 turns
  for (std::size_t i = 0; i + 1 < counts.size(); ++i) {
    EXPECT_NEAR(static_cast<double>(counts[i]), 360.0 / 0.77, 1.0);
  }
}

TEST_F(Sweeps, MayTurnTheOtherWay) {
  for (int i = 0; i < 2500; ++i) column(i, 360.0 - std::fmod(i * deg_per_column + 1e-9, 360.0));
  const Sizes counts = sizes();
  ASSERT_EQ(counts.size(), 3U);
  EXPECT_NEAR(static_cast<double>(counts[0]), 1000.0, 1.0);
}

TEST_F(Sweeps, JitterIsNoTurn) {
  for (int i = 0; i < 2500; ++i) {
    column(i, std::fmod(i * deg_per_column + (i % 2 == 0 ? 0.0 : 0.5) + 0.1, 360.0));
  }
  EXPECT_EQ(sizes().size(), 3U);
}

TEST_F(Sweeps, DirectionsMayBeSwitchedOff) {
  for (int i = 0; i < 3000; ++i) {
    const double azimuth = std::fmod(i * deg_per_column, 360.0);
    if (azimuth < 90.0) column(i, azimuth);
  }
  EXPECT_EQ(sizes(), (Sizes{250, 250, 250}));
}

TEST_F(Sweeps, EndAtInterruptions) {
  turning(0, 300);
  turning(3400, 3600);  // 0.31 s later
  EXPECT_EQ(sizes(), (Sizes{300, 200}));
}

TEST_F(Sweeps, EndWhereATurnWasLost) {
  turning(0, 300);
  turning(1310, 1600);  // goes on one turn later
  EXPECT_EQ(sizes(), (Sizes{300, 290}));
}

TEST_F(Sweeps, LosingLessThanHalfATurnDoesNotEndThem) {
  turning(0, 300);
  turning(700, 1000);
  EXPECT_EQ(sizes(), (Sizes{600}));
}

TEST_F(Sweeps, EndAfterASecondWhereTheMotorRests) {
  for (int i = 0; i < 25'000; ++i) column(i, 77.0);
  EXPECT_EQ(sizes(), (Sizes{10'001, 10'001, 4'998}));
}

TEST_F(Sweeps, OfAClockThatWasNeverSetAreStampedByTheHost) {
  at_ns(5'000'000, 0.0);
  at_ns(6'000'000, 1.0);
  EXPECT_EQ(sizes(), (Sizes{2}));
  EXPECT_EQ(sweeps_[0].stamp_ns, start_ns);
  EXPECT_FLOAT_EQ(sweeps_[0].time_offsets[1], 1e-3F);
}

TEST_F(Sweeps, AreStampedByTheirEarliestPoint) {
  builder_.begin_column(0.0, start_ns, start_ns, 3);
  for (const std::int64_t ns : {5000, 2000, 9000}) {
    builder_.add({1.0F, 0.0F, 0.0F}, 0.0F, start_ns + ns);
  }
  EXPECT_EQ(sizes(), (Sizes{3}));
  EXPECT_EQ(sweeps_[0].stamp_ns, start_ns + 2000);
  EXPECT_FLOAT_EQ(sweeps_[0].time_offsets[0], 3e-6F);
  EXPECT_EQ(sweeps_[0].time_offsets[1], 0.0F);
}

TEST_F(Sweeps, WithoutPointsAreNone) {
  for (int i = 0; i < 2500; ++i) {
    builder_.begin_column(i % 360, start_ns + i * column_ns, start_ns, 1);
  }
  EXPECT_EQ(sizes(), Sizes{});
}

TEST_F(Sweeps, BearTimesFromEndToEnd) {
  constexpr std::int64_t far = std::numeric_limits<std::int64_t>::max();
  for (const std::int64_t ns : {far, -far, std::int64_t{0}, far}) at_ns(ns, 0.0);
  EXPECT_EQ(sizes(), (Sizes{1, 1, 1, 1}));
}

}  // namespace
}  // namespace kissmap
