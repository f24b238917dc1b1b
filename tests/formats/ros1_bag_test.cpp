// SPDX-License-Identifier: MIT
// ROS 1 bags made byte by byte: closed, left open by a recorder that was killed, and split.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "formats/message_bytes.hpp"
#include "formats/ros1_bag_bytes.hpp"
#include "formats/support.hpp"

namespace kissmap {
namespace {

using test::BagChunk;
using test::BagConnection;
using test::BagMessage;
using test::error_of;
using test::read_all;
using test::refusal_of;
using test::Ros1BagBytes;
using test::RosForm;
using test::scan_of;
using test::TempDir;
using testing::AllOf;
using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;
using testing::Optional;

constexpr std::uint32_t start_s = 1'700'000'000;
constexpr std::int64_t start_ns = 1'700'000'000'000'000'000;
constexpr std::uint32_t points = 5;  // numbers of connections
constexpr std::uint32_t imu = 2;

const std::vector<BagConnection> connections{{imu, "/imu", "sensor_msgs/Imu"},
                                             {points, "/points", "sensor_msgs/PointCloud2"}};

/// A cloud with one point (second, 2, 3), stamped with that second and received half of one later.
BagMessage cloud_at(std::uint32_t second, std::uint32_t connection = points) {
  auto cloud = test::plain_cloud({{static_cast<float>(second), 2, 3}});
  cloud.seconds = start_s + second;
  return {connection, start_s + second, 500'000'000, point_cloud2(RosForm::ros1, cloud)};
}
BagMessage imu_at(std::uint32_t second) {
  return {imu, start_s + second, 0, "not a cloud"};
}

std::vector<float> seconds_of(const std::vector<LogEntry>& entries) {
  std::vector<float> seconds;
  for (const LogEntry& entry : entries) {
    const Scan& scan = scan_of(entry);
    seconds.push_back(scan.points.at(0).x());
    EXPECT_EQ(scan.points.size(), 1U);
    EXPECT_EQ(scan.points.at(0).tail<2>(), Eigen::Vector2f(2, 3));
    EXPECT_EQ(scan.stamp_ns, start_ns + static_cast<std::int64_t>(seconds.back()) * 1'000'000'000);
  }
  return seconds;
}

const std::vector<BagChunk> three_chunks{
    {imu_at(0), cloud_at(1), cloud_at(2)}, {imu_at(3)}, {cloud_at(4), imu_at(5), cloud_at(6)}};

TEST(Ros1Bag, ItsFirstRecordBeginsAtByte4117) {
  const std::string bag = Ros1BagBytes(connections, three_chunks).closed();
  // 13 bytes, then a record whose spaces fill it up to 4096 bytes and two lengths.
  EXPECT_EQ(bag.substr(0, 13), "#ROSBAG V2.0\n");
  EXPECT_EQ(bag[4116], ' ');
  EXPECT_EQ(bag.substr(4117 + 4, 8), test::hex("04 00 00 00") + "op=\x05");
  const TempDir dir;
  EXPECT_THAT(seconds_of(read_all(*open_log(dir.write("log.bag", bag)))), ElementsAre(1, 2, 4, 6));
  // A byte before it is missing: neither the index nor the chunks are where they should be.
  const auto broken = dir.write("broken.bag", bag.substr(0, 4116) + bag.substr(4117));
  EXPECT_THAT(error_of(Fault::input, [&] { open_log(broken); }),
              AllOf(HasSubstr("broken.bag"), HasSubstr("at byte 4117")));
}

TEST(Ros1Bag, ClosedTellsFromItsIndex) {
  const TempDir dir;
  const auto log = open_log(dir.write("log.bag", Ros1BagBytes(connections, three_chunks).closed()));
  const LogInfo& info = log->info();
  EXPECT_EQ(info.format, "rosbag");
  EXPECT_THAT(info.scan_count, Optional(4U));
  EXPECT_THAT(info.time_range, Optional(std::pair(start_ns, start_ns + 6'500'000'000)));
  EXPECT_THAT(info.notes, Not(Contains(HasSubstr("no index"))));
  ASSERT_EQ(info.topics.size(), 2U);
  EXPECT_EQ(info.topics[0].name, "/imu");
  EXPECT_THAT(info.topics[0].message_count, Optional(3U));
  EXPECT_THAT(log->known_times(),
              Optional(ElementsAre(1'700'000'001'500'000'000,
                                   1'700'000'002'500'000'000,
                                   1'700'000'004'500'000'000,
                                   1'700'000'006'500'000'000)));
  log->skip(2);
  EXPECT_THAT(seconds_of(read_all(*log)), ElementsAre(4, 6));
}

TEST(Ros1Bag, LeftOpenIsLookedThroughAndGivesTheSame) {
  const TempDir dir;
  const auto path = dir.write("log.bag", Ros1BagBytes(connections, three_chunks).open());
  const auto log = open_log(path);
  EXPECT_THAT(log->info().scan_count, Optional(4U));
  EXPECT_THAT(log->info().notes, Contains(AllOf(HasSubstr("log.bag"), HasSubstr("no index"))));
  EXPECT_THAT(log->info().time_range, Optional(std::pair(start_ns, start_ns + 6'500'000'000)));
  EXPECT_THAT(seconds_of(read_all(*log)), ElementsAre(1, 2, 4, 6));
  const auto again = open_log(path);
  again->skip(3);
  EXPECT_THAT(seconds_of(read_all(*again)), ElementsAre(6));
}

TEST(Ros1Bag, LeftOpenInAChunkGivesTheMessagesBeforeAndSaysWhere) {
  const TempDir dir;
  const std::string whole = Ros1BagBytes(connections, three_chunks).open();
  // Into the points of the last message: all that stands behind them is its own end and the index
  // records of the chunk.
  const std::size_t cut = whole.rfind(test::little<float>(6) + test::little<float>(2)) + 5;
  auto entries = read_all(*open_log(dir.write("log.bag", whole.substr(0, cut))));
  ASSERT_EQ(entries.size(), 4U);
  EXPECT_EQ(refusal_of(entries.back()).reason, "truncated file");
  EXPECT_THAT(refusal_of(entries.back()).detail, AllOf(HasSubstr("log.bag"), HasSubstr("byte")));
  entries.pop_back();
  EXPECT_THAT(seconds_of(entries), ElementsAre(1, 2, 4));
}

// The recorder wrote where the index will be, but not all of it.
TEST(Ros1Bag, WithAnIndexCutShortIsLookedThrough) {
  const TempDir dir;
  const std::string whole = Ros1BagBytes(connections, three_chunks).closed();
  const std::size_t last_info = whole.rfind("chunk_pos");
  const auto log = open_log(dir.write("log.bag", whole.substr(0, last_info)));
  EXPECT_THAT(log->info().notes, Contains(HasSubstr("no index")));
  auto entries = read_all(*log);
  ASSERT_EQ(entries.size(), 5U);
  EXPECT_EQ(refusal_of(entries.back()).reason, "truncated file");
  entries.pop_back();
  EXPECT_THAT(seconds_of(entries), ElementsAre(1, 2, 4, 6));
}

TEST(Ros1Bag, MessagesComeInTheOrderOfTheirTimes) {
  const TempDir dir;
  const std::vector<BagChunk> overlapping{{cloud_at(1), cloud_at(4)}, {cloud_at(2), cloud_at(3)}};
  const Ros1BagBytes bag(connections, overlapping);
  for (const std::string& bytes : {bag.closed(), bag.open()}) {
    EXPECT_THAT(seconds_of(read_all(*open_log(dir.write("log.bag", bytes)))),
                ElementsAre(1, 2, 3, 4));
  }
}

TEST(Ros1Bag, TwoPublishersOfATopicAreOneTopic) {
  const TempDir dir;
  std::vector<BagConnection> two = connections;
  two.push_back({9, "/points", "sensor_msgs/PointCloud2"});
  const Ros1BagBytes bag(two, {{cloud_at(1, 9), cloud_at(2)}, {cloud_at(3, 9)}});
  for (const std::string& bytes : {bag.closed(), bag.open()}) {
    const auto log = open_log(dir.write("log.bag", bytes));
    EXPECT_THAT(log->info().scan_count, Optional(3U));
    EXPECT_THAT(seconds_of(read_all(*log)), ElementsAre(1, 2, 3));
  }
}

// Each part counts its connections anew, and the second was not closed. By name it comes first.
TEST(Ros1Bag, PartsOfARecordingAreReadInTheOrderOfTime) {
  const TempDir dir;
  const std::vector<BagConnection> other_way{{imu, "/points", "sensor_msgs/PointCloud2"},
                                             {points, "/imu", "sensor_msgs/Imu"}};
  dir.write("run/log_2.bag", Ros1BagBytes(connections, three_chunks).closed());
  dir.write(
      "run/log_1.bag",
      Ros1BagBytes(other_way, {{cloud_at(7, imu)}, {cloud_at(8, imu), cloud_at(9, imu)}}).open());
  dir.write("run/log_10.bag", Ros1BagBytes(connections, {{imu_at(10)}, {cloud_at(11)}}).closed());
  const auto log = open_log(dir.path() / "run");
  EXPECT_EQ(log->info().format, "rosbag");
  EXPECT_THAT(log->info().scan_count, Optional(8U));
  EXPECT_THAT(log->info().notes, Contains(AllOf(HasSubstr("log_1.bag"), HasSubstr("no index"))));
  EXPECT_EQ(log->info().topics.size(), 2U);
  EXPECT_EQ(log->files().size(), 3U);
  EXPECT_THAT(seconds_of(read_all(*log)), ElementsAre(1, 2, 4, 6, 7, 8, 9, 11));
  const auto from_the_second = open_log(dir.path() / "run");
  from_the_second->skip(5);
  const auto entry = from_the_second->next();
  ASSERT_TRUE(entry.has_value());
  EXPECT_EQ(entry->index, 5U);
  EXPECT_EQ(scan_of(*entry).points[0].x(), 8.0F);
}

TEST(Ros1Bag, APartThatIsCutLosesNothingOfTheOthers) {
  const TempDir dir;
  const std::string whole = Ros1BagBytes(connections, three_chunks).open();
  dir.write("run/a.bag", whole.substr(0, whole.size() - 300));
  dir.write("run/b.bag", Ros1BagBytes(connections, {{cloud_at(7)}, {cloud_at(8)}}).closed());
  std::vector<LogEntry> scans;
  std::vector<std::string> details;
  for (LogEntry& entry : read_all(*open_log(dir.path() / "run"))) {
    if (std::holds_alternative<RefusedScan>(entry.content)) {
      details.push_back(refusal_of(entry).detail);
    } else {
      scans.push_back(std::move(entry));
    }
  }
  EXPECT_THAT(seconds_of(scans), ElementsAre(1, 2, 4, 7, 8));
  EXPECT_THAT(details, ElementsAre(HasSubstr("a.bag")));
}

TEST(Ros1Bag, WithoutMessagesIsAnError) {
  const TempDir dir;
  for (const std::string& bytes :
       {Ros1BagBytes(connections, {}).closed(), Ros1BagBytes({}, {}).open()}) {
    const auto path = dir.write("empty.bag", bytes);
    EXPECT_THAT(error_of(Fault::input, [&] { open_log(path); }), HasSubstr("empty.bag"));
  }
}

}  // namespace
}  // namespace kissmap
