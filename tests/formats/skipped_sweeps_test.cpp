// SPDX-License-Identifier: MIT
// Bags and captures of packets: after skip() they go on as if all had been read.
#include <gtest/gtest.h>

#include <algorithm>

#include "formats/allocation_meter.hpp"
#include "formats/logs/sweep_maker.hpp"
#include "formats/message_scans.hpp"
#include "formats/packet_streams.hpp"
#include "formats/ros1_bag_bytes.hpp"
#include "formats/same_scans.hpp"
#include "formats/sensor_recording.hpp"
#include "formats/support.hpp"
#include "formats/turning_capture.hpp"

namespace kissmap {
namespace {

namespace fs = std::filesystem;
using test::BagMessage;
using test::expect_same;
using test::PacketStream;
using test::read_all;
using test::RosBytes;
using test::RosForm;
using test::TempDir;
using Entries = std::vector<LogEntry>;

std::string text_of(const std::vector<std::byte>& bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

void expect_entries(const Entries& found, const Entries& all, std::size_t first) {
  ASSERT_EQ(found.size(), all.size() - std::min(all.size(), first));
  for (std::size_t i = 0; i < found.size(); ++i) {
    SCOPED_TRACE("entry " + std::to_string(first + i));
    expect_same(found[i], all[first + i]);
  }
}

/// Skips, reads one, skips and reads the rest.
void expect_skipped_twice(ScanLog& log, const Entries& all, std::size_t a, std::size_t b) {
  log.skip(a);
  Entries found;
  if (auto entry = log.next()) found.push_back(std::move(*entry));
  expect_entries(found, Entries(all.begin(), all.begin() + std::min(a + 1, all.size())), a);
  log.skip(b);
  expect_entries(read_all(log), all, a + 1 + b);
  EXPECT_FALSE(log.next().has_value());
}

void expect_selected(const fs::path& path, const ReadOptions& options, const Entries& all) {
  const auto log = select_scans(open_log(path, options), {1, std::nullopt, 3});
  for (std::size_t i = 1; i < all.size(); i += 3) {
    const auto entry = log->next();
    ASSERT_TRUE(entry.has_value());
    expect_same(*entry, all[i]);
  }
  EXPECT_FALSE(log->next().has_value());
}

/// Returns how many entries there are.
std::size_t expect_skips(const fs::path& path, const ReadOptions& options = {}) {
  const Entries all = read_all(*open_log(path, options));
  for (std::size_t first = 0; first <= all.size() + 1; ++first) {
    SCOPED_TRACE("skipped " + std::to_string(first));
    const auto log = open_log(path, options);
    log->skip(first);
    expect_entries(read_all(*log), all, first);
    expect_skipped_twice(*open_log(path, options), all, first, 1 + first % 4);
  }
  expect_selected(path, options, all);
  return all.size();
}

class SkippedSweeps : public testing::TestWithParam<std::size_t> {
 protected:
  SkippedSweeps() : stream_(test::packet_stream(GetParam())) {
    if (stream_.calibration.empty()) return;
    const char* name = stream_.family == SensorFamily::ouster ? "unit.json" : "unit.yaml";
    options_.calibration = dir_.write(name, stream_.calibration).string();
  }

  TempDir dir_;
  PacketStream stream_;
  ReadOptions options_;
};

TEST_P(SkippedSweeps, OfCapturesLeaveTheRestAsItIs) {
  SCOPED_TRACE(stream_.name);
  std::string file = test::pcap_head(1, std::endian::little, 0xA1B2C3D4);
  for (const auto& packet : stream_.packets) {
    const std::int64_t us = packet.received_ns / 1000 - test::turn_start_s * 1'000'000;
    file += test::datagram_record(us, 2368, text_of(packet.payload));
  }
  EXPECT_EQ(expect_skips(dir_.write("c.pcap", file), options_), test::turns - 1);
  file.resize(file.size() - 7);
  EXPECT_EQ(expect_skips(dir_.write("cut.pcap", file), options_), test::turns);
}

struct PacketTopic {
  const char* type;
  std::size_t packets;  ///< of a message: more than a turn of some sensors, less of others
};

PacketTopic topic_of(SensorFamily family) {
  if (family == SensorFamily::velodyne) return {"velodyne_msgs/VelodyneScan", 40};
  if (family == SensorFamily::hesai) return {"nebula_msgs/NebulaPackets", 110};
  return {"ouster_sensor_msgs/PacketMsg", 1};
}

std::string message_of(const PacketStream& stream, std::size_t first, std::size_t count) {
  if (stream.family == SensorFamily::ouster) {
    return RosBytes(RosForm::ros1).sequence(text_of(stream.packets[first].payload)).bytes();
  }
  const std::size_t end = std::min(first + count, stream.packets.size());
  RosBytes bytes(RosForm::ros1);
  bytes.header(1'700'000'000, 5, "sensor");
  bytes.add<std::uint32_t>(static_cast<std::uint32_t>(end - first));
  for (std::size_t i = first; i < end; ++i) {
    const std::int64_t ns = stream.packets[i].received_ns;
    bytes.time(static_cast<std::uint32_t>(ns / 1'000'000'000),
               static_cast<std::uint32_t>(ns % 1'000'000'000));
    const std::string payload = text_of(stream.packets[i].payload);
    if (stream.family == SensorFamily::hesai) {
      bytes.sequence(payload);
    } else {
      bytes.raw(payload);
    }
  }
  return bytes.bytes();
}

/// Messages one after the other: `cut[i]` says how much the end of message i lacks. A cut message
/// is refused, whatever came of its packets.
std::string bag_of(const PacketStream& stream, const std::vector<std::size_t>& cut) {
  const PacketTopic topic = topic_of(stream.family);
  test::BagChunk messages;
  for (std::size_t first = 0; first < stream.packets.size(); first += topic.packets) {
    BagMessage message{0, 1'700'000'000, static_cast<std::uint32_t>(first), {}};
    message.data = message_of(stream, first, topic.packets);
    const std::size_t number = first / topic.packets;
    if (number < cut.size()) message.data.resize(message.data.size() - cut[number]);
    messages.push_back(std::move(message));
  }
  std::vector<test::BagConnection> connections{{0, "/packets", topic.type}};
  if (stream.family == SensorFamily::ouster) {  // packets come before the metadata, too
    connections.push_back({1, "/metadata", "std_msgs/String"});
    const std::string text = RosBytes(RosForm::ros1).text(stream.calibration).bytes();
    messages.insert(messages.begin() + 5, {1, 1'700'000'000, 4, text});
  }
  return test::Ros1BagBytes(connections, {messages}).closed();
}

/// So that metadata comes from the bag.
ReadOptions bag_options(const PacketStream& stream, const ReadOptions& options) {
  return stream.family == SensorFamily::ouster ? ReadOptions{} : options;
}

TEST_P(SkippedSweeps, OfBagsLeaveTheRestAsItIs) {
  SCOPED_TRACE(stream_.name);
  const fs::path bag = dir_.write("b.bag", bag_of(stream_, {}));
  EXPECT_EQ(expect_skips(bag, bag_options(stream_, options_)), test::turns - 1);
}

// Each refused message counts, too: some in a row come in the middle of a sweep, where those before
// may count for what is skipped and the sweep not. One of Hesai is cut so late that its sweeps come
// after its refusal.
TEST_P(SkippedSweeps, OfBagsWithBrokenMessagesLeaveTheRestAsItIs) {
  SCOPED_TRACE(stream_.name);
  const std::size_t messages = stream_.packets.size() / topic_of(stream_.family).packets;
  const std::size_t begin = messages * 3 / 10;  // of the second turn
  for (const std::size_t row : {1U, 3U}) {
    std::vector<std::size_t> cut(begin + row);
    std::fill(cut.begin() + static_cast<std::ptrdiff_t>(begin), cut.end(), 5);
    const fs::path bag = dir_.write("b.bag", bag_of(stream_, cut));
    EXPECT_GE(expect_skips(bag, bag_options(stream_, options_)), row + 2);
  }
}

TEST_P(SkippedSweeps, OfAMakerHaveFewPoints) {
  SCOPED_TRACE(stream_.name);
  const PacketTopic topic = topic_of(stream_.family);
  const auto maker = make_sweep_maker(test::topic_of(RosForm::ros1, topic.type), options_);
  maker->pass(1);
  std::vector<Scan> scans;
  for (std::size_t i = 0; i < stream_.packets.size(); i += topic.packets) {
    const std::string bytes = message_of(stream_, i, topic.packets);
    maker->add({0, stream_.packets[i].received_ns, test::bytes_of(bytes)},
               test::topic_of(RosForm::ros1, topic.type));
    while (auto scan = maker->take()) scans.push_back(std::move(*scan));
  }
  ASSERT_GE(scans.size(), 2U);
  EXPECT_LE(scans[0].points.size(), stream_.column_returns);
  EXPECT_GT(scans[1].points.size(), 50 * stream_.column_returns);
}

INSTANTIATE_TEST_SUITE_P(Sensors,
                         SkippedSweeps,
                         testing::Range<std::size_t>(0, test::stream_count));

// A turn of an Alpha Prime with all its returns between such as have hardly any: the room for its
// points is asked for only where it is wanted.
TEST(SkippedSweepsOfACapture, AreNotDecoded) {
  PacketStream stream = test::velodyne_stream({"VLS-128", 0xA1, 0x37, 4, 40, 53.3});
  const std::size_t packets_of_a_turn = stream.packets.size() / test::turns;
  std::string file = test::pcap_head(1, std::endian::little, 0xA1B2C3D4);
  for (std::size_t i = 0; i < stream.packets.size(); ++i) {
    std::vector<std::byte>& bytes = stream.packets[i].payload;
    const bool bare = i / packets_of_a_turn != 1 && i % packets_of_a_turn > 10;
    for (std::size_t at = 0; bare && at < 1200; ++at) {
      if (at % 100 > 3) bytes[at] = std::byte{0};
    }
    const std::int64_t us = stream.packets[i].received_ns / 1000 - 1'700'000'000'000'000;
    file += test::datagram_record(us, 2368, text_of(bytes));
  }
  const TempDir dir;
  const fs::path path = dir.write("c.pcap", file);
  const auto log = open_log(path);
  test::forget_allocations();
  log->skip(3);
  const std::size_t skipping = test::largest_allocation();
  if (skipping == 0) GTEST_SKIP() << "a sanitizer owns the memory";
  const auto again = open_log(path);
  test::forget_allocations();
  const Entries all = read_all(*again);
  EXPECT_GT(test::scan_of(all.at(1)).points.size(), 50'000U);
  EXPECT_GT(test::largest_allocation(), 2 * skipping);
}

class SkippedRecordings : public test::PacketRecordings {};

TEST_F(SkippedRecordings, LeaveTheRestAsItIs) {
  std::size_t recordings = 0;
  for (const auto& file : fs::recursive_directory_iterator(packets_)) {
    const fs::path ending = file.path().extension();
    if (ending != ".pcap" && ending != ".bag" && ending != ".db3") continue;
    SCOPED_TRACE(file.path());
    ++recordings;
    EXPECT_GE(expect_skips(ending == ".db3" ? file.path().parent_path() : file.path()), 1U);
  }
  EXPECT_GE(recordings, 15U);
}

}  // namespace
}  // namespace kissmap
