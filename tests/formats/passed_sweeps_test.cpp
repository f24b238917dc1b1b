// SPDX-License-Identifier: MIT
// Sweeps that a decoder passes over: they have next to no points, and leave no trace in others.
#include <gtest/gtest.h>

#include <random>

#include "formats/packet_streams.hpp"
#include "formats/same_scans.hpp"
#include "formats/sensor_recording.hpp"
#include "formats/sensors/sweep_builder.hpp"

namespace kissmap {
namespace {

using test::expect_same;
using test::PacketStream;

/// A decoder is told to pass over so many sweeps before a packet.
struct Order {
  std::size_t packet = 0;
  std::size_t sweeps = 0;
};

struct Decoded {
  std::vector<Scan> sweeps;
  std::vector<std::size_t> complete;  ///< before each packet, and before the end
  PacketCounts counts;
};

Decoded decode(const PacketStream& stream, const std::vector<Order>& orders = {}) {
  const auto decoder = stream.make();
  Decoded decoded;
  for (std::size_t i = 0; i <= stream.packets.size(); ++i) {
    while (auto scan = decoder->take()) decoded.sweeps.push_back(std::move(*scan));
    decoded.complete.push_back(decoded.sweeps.size());
    for (const Order& order : orders) {
      if (order.packet == i) decoder->pass(order.sweeps);
    }
    if (i == stream.packets.size()) break;
    decoder->add(stream.packets[i].payload, stream.packets[i].received_ns);
  }
  decoder->finish();
  while (auto scan = decoder->take()) decoded.sweeps.push_back(std::move(*scan));
  decoded.counts = decoder->counts();
  return decoded;
}

/// What is there of a sweep that was passed over is how it begins.
void expect_beginning(const Scan& scan, const Scan& whole) {
  EXPECT_NO_THROW(require_consistent(scan));
  ASSERT_FALSE(scan.points.empty());
  ASSERT_LE(scan.points.size(), whole.points.size());
  EXPECT_TRUE(std::equal(scan.points.begin(), scan.points.end(), whole.points.begin()));
}

/// Sweeps from `begin` to `end` are passed over.
void expect_passed(const Decoded& passed,
                   const Decoded& whole,
                   std::size_t begin,
                   std::size_t end) {
  EXPECT_EQ(passed.complete, whole.complete);
  EXPECT_EQ(passed.counts.decoded, whole.counts.decoded);
  EXPECT_EQ(passed.counts.foreign, whole.counts.foreign);
  EXPECT_EQ(passed.counts.damaged, whole.counts.damaged);
  ASSERT_EQ(passed.sweeps.size(), whole.sweeps.size());
  for (std::size_t i = 0; i < whole.sweeps.size(); ++i) {
    SCOPED_TRACE("sweep " + std::to_string(i));
    if (i >= begin && i < end) {
      expect_beginning(passed.sweeps[i], whole.sweeps[i]);
    } else {
      expect_same(passed.sweeps[i], whole.sweeps[i]);
    }
  }
}

class PassedSweeps : public testing::TestWithParam<std::size_t> {
 protected:
  PassedSweeps() : stream_(test::packet_stream(GetParam())), whole_(decode(stream_)) {}

  void expect_passed_anywhere() const {
    std::mt19937 random(2);
    for (int round = 0; round < 10; ++round) {
      std::size_t from = random() % stream_.packets.size();
      std::size_t to = random() % stream_.packets.size();
      if (from > to) std::swap(from, to);
      SCOPED_TRACE(std::to_string(from) + " to " + std::to_string(to));
      const Decoded passed = decode(stream_, {{from, 100}, {to, 0}});
      expect_passed(passed, whole_, whole_.complete[from], whole_.complete[to]);
    }
  }

  PacketStream stream_;
  Decoded whole_;
};

TEST_P(PassedSweeps, FromTheBeginningHaveTheReturnsOfOneColumn) {
  SCOPED_TRACE(stream_.name);
  ASSERT_EQ(whole_.sweeps.size(), test::turns - 1) << "a turn without returns is none";
  for (const std::size_t count : {1U, 2U, 3U, 4U, 100U}) {
    SCOPED_TRACE(count);
    const Decoded passed = decode(stream_, {{0, count}});
    expect_passed(passed, whole_, 0, count);
    for (std::size_t i = 0; i < std::min(count, passed.sweeps.size()); ++i) {
      EXPECT_GT(whole_.sweeps[i].points.size(), 50 * stream_.column_returns);
      EXPECT_LE(passed.sweeps[i].points.size(), stream_.column_returns);
    }
  }
}

// A sweep is whole if it is wanted when it ends, whatever was said before that.
TEST_P(PassedSweeps, BeginAndEndAnywhere) {
  SCOPED_TRACE(stream_.name);
  expect_passed_anywhere();
}

// Azimuths, times and marks, too, are any numbers in some of them.
TEST_P(PassedSweeps, BeginAndEndAnywhereAmongDamagedPackets) {
  SCOPED_TRACE(stream_.name);
  std::mt19937 random(3);
  for (std::size_t i = 1; i < stream_.packets.size(); i += 1 + random() % 20) {
    std::vector<std::byte>& bytes = stream_.packets[i].payload;
    for (int change = 0; change < 9; ++change) {
      // Not in what tells the sensor: packets of others are only counted.
      bytes[12 + random() % (bytes.size() - 14)] = static_cast<std::byte>(random() & 255U);
    }
  }
  whole_ = decode(stream_);
  EXPECT_GT(whole_.sweeps.size(), 2U);
  expect_passed_anywhere();
}

TEST_P(PassedSweeps, AreAsManyAsWasSaidLast) {
  SCOPED_TRACE(stream_.name);
  const std::size_t middle = stream_.packets.size() * 3 / 10;  // of the second turn
  const Decoded passed = decode(stream_, {{0, 5}, {middle, 1}});
  expect_passed(passed, whole_, 0, whole_.complete[middle] + 1);
  expect_passed(decode(stream_, {{0, 2}, {middle, 0}, {middle, 1}}), whole_, 0, 2);
}

// Of those that are complete nothing can be left out.
TEST_P(PassedSweeps, BeginWithThoseThatAreComplete) {
  SCOPED_TRACE(stream_.name);
  const auto decoder = stream_.make();
  const std::size_t middle = stream_.packets.size() / 2;  // of the silent turn
  const std::size_t complete = whole_.complete[middle];
  ASSERT_GE(complete, 1U);
  for (std::size_t i = 0; i < stream_.packets.size(); ++i) {
    if (i == middle) decoder->pass(complete + 1);
    decoder->add(stream_.packets[i].payload, stream_.packets[i].received_ns);
  }
  decoder->finish();
  Decoded passed = whole_;
  passed.sweeps = test::take_all(*decoder);
  expect_passed(passed, whole_, complete, complete + 1);
  EXPECT_LT(passed.sweeps.at(complete).points.size(), whole_.sweeps[complete].points.size());
}

INSTANTIATE_TEST_SUITE_P(Sensors, PassedSweeps, testing::Range<std::size_t>(0, test::stream_count));

TEST(PassedSweepsOfABuilder, EndAtAsManyShotsAsOthers) {
  constexpr std::size_t shots = 100'000;  // of a column, of which one returns
  const auto points_after = [](std::size_t to_pass) {
    std::deque<Scan> sweeps;
    SweepBuilder builder(sweeps);
    builder.pass(to_pass);
    for (int i = 0; i < 100; ++i) {
      builder.begin_column(0.0, i, 0, shots);
      const std::vector<std::byte> none;
      KeptPacket packet{PacketBytes(none)};
      builder.decode_column(packet, [&](const PacketBytes&) {
        builder.add({1.0F, 2.0F, 3.0F}, 4.0F, i);
      });
    }
    builder.finish();
    std::vector<std::size_t> points;
    for (const Scan& sweep : sweeps) points.push_back(sweep.points.size());
    return points;
  };
  EXPECT_EQ(points_after(0), (std::vector<std::size_t>{41, 41, 18}));
  EXPECT_EQ(points_after(1), (std::vector<std::size_t>{1, 41, 18}));
  EXPECT_EQ(points_after(2), (std::vector<std::size_t>{1, 1, 18}));
}

// Returns that cannot be are none: the sweep is there only because of those that can.
TEST(PassedSweepsOfABuilder, NeedAReturnThatCanBe) {
  std::deque<Scan> sweeps;
  SweepBuilder builder(sweeps);
  builder.pass(1);
  const std::vector<std::byte> none;
  KeptPacket packet{PacketBytes(none)};
  for (int i = 0; i < 30; ++i) {
    const float range = i < 20 || i % 2 == 0 ? 1e6F : 1.0F;  // of the first sweep none
    builder.begin_column(36.0 * (i % 10), i * 1'000'000, 0, 1);
    builder.decode_column(packet, [&](const PacketBytes&) {
      builder.add({range, 0.0F, 0.0F}, 0.0F, i * 1'000'000);
    });
  }
  builder.finish();
  ASSERT_EQ(sweeps.size(), 1U);
  EXPECT_EQ(sweeps[0].stamp_ns, 21'000'000);
  EXPECT_EQ(sweeps[0].points.size(), 1U);
}

}  // namespace
}  // namespace kissmap
