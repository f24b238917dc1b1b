// SPDX-License-Identifier: MIT
// Containers of 20 GB that are holes but for their first chunk and their index: what is told of
// them comes from the index, and so do gaps.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>

#include "formats/support.hpp"

namespace kissmap {
namespace {

namespace fs = std::filesystem;
using test::Bytes;
using test::TempDir;
using testing::ElementsAre;
using testing::Optional;

constexpr std::size_t chunks = 5000;
constexpr std::uint64_t chunk_bytes = 4 << 20;
constexpr std::size_t pause_before = 3000;  // chunk
constexpr std::uint64_t most_bytes = 64 << 20;

std::uint64_t stamp_s(std::size_t chunk) {
  return 1'700'000'000 + chunk + (chunk >= pause_before ? 60 : 0);
}

/// Bytes this process has asked the kernel for.
std::uint64_t bytes_read() {
  std::ifstream io("/proc/self/io");
  std::string name;
  std::uint64_t count = 0;
  io >> name >> count;
  EXPECT_EQ(name, "rchar:");
  return count;
}

std::string text32(const std::string& text) {
  return Bytes().add<std::uint32_t>(static_cast<std::uint32_t>(text.size())).text() + text;
}

/// sensor_msgs/PointCloud2 of ROS 1 with one point.
std::string cloud() {
  std::string message =
      Bytes().add<std::uint32_t>(0).add<std::uint32_t>(1'700'000'000).add<std::uint32_t>(0).text() +
      text32("l") +
      Bytes().add<std::uint32_t>(1).add<std::uint32_t>(1).add<std::uint32_t>(3).text();
  std::uint32_t offset = 0;
  for (const char* name : {"x", "y", "z"}) {
    message += text32(name) +
               Bytes().add<std::uint32_t>(offset).add<std::uint8_t>(7).add<std::uint32_t>(1).text();
    offset += 4;
  }
  return message +
         Bytes().add<std::uint8_t>(0).add<std::uint32_t>(12).add<std::uint32_t>(12).text() +
         text32(Bytes().add<float>(1).add<float>(2).add<float>(3).text()) +
         Bytes().add<std::uint8_t>(1).text();
}

std::string mcap_record(std::uint8_t op, const std::string& content) {
  return Bytes().add<std::uint8_t>(op).add<std::uint64_t>(content.size()).text() + content;
}

fs::path sparse_mcap(const TempDir& dir) {
  const std::string magic("\x89MCAP0\r\n", 8);
  const std::string described =
      mcap_record(3,
                  Bytes().add<std::uint16_t>(1).text() + text32("sensor_msgs/PointCloud2") +
                      text32("ros1msg") + text32("")) +
      mcap_record(4,
                  Bytes().add<std::uint16_t>(0).add<std::uint16_t>(1).text() + text32("/points") +
                      text32("ros1") + text32(""));
  const fs::path path = dir.path() / "large.mcap";
  std::ofstream file(path, std::ios::binary);
  file << magic << mcap_record(1, text32("ros1") + text32(""));
  std::string indexes;
  for (std::size_t i = 0; i < chunks; ++i) {
    const std::uint64_t time = stamp_s(i) * 1'000'000'000;
    std::string records = described + mcap_record(5,
                                                  Bytes().add<std::uint16_t>(0)
                                                          .add<std::uint32_t>(0)
                                                          .add<std::uint64_t>(time)
                                                          .add<std::uint64_t>(time)
                                                          .text() +
                                                      cloud());
    const std::uint64_t size = i == 0 ? records.size() : chunk_bytes;
    const std::string head = Bytes()
                                 .add<std::uint64_t>(time)
                                 .add<std::uint64_t>(time)
                                 .add<std::uint64_t>(size)
                                 .add<std::uint32_t>(0)
                                 .text() +
                             text32("") + Bytes().add<std::uint64_t>(size).text();
    const auto offset = static_cast<std::uint64_t>(file.tellp());
    file << Bytes().add<std::uint8_t>(6).add<std::uint64_t>(head.size() + size).text() << head;
    if (i == 0) file << records;
    file.seekp(static_cast<std::streamoff>(offset + 9 + head.size() + size));
    const auto index = static_cast<std::uint64_t>(file.tellp());
    const std::string entry = mcap_record(7,
                                          Bytes()
                                              .add<std::uint16_t>(0)
                                              .add<std::uint32_t>(16)
                                              .add<std::uint64_t>(time)
                                              .add<std::uint64_t>(described.size())
                                              .text());
    file << entry;
    indexes += mcap_record(8,
                           Bytes().add<std::uint64_t>(time)
                                   .add<std::uint64_t>(time)
                                   .add<std::uint64_t>(offset)
                                   .add<std::uint64_t>(index - offset)
                                   .add<std::uint32_t>(10)
                                   .add<std::uint16_t>(0)
                                   .add<std::uint64_t>(index)
                                   .add<std::uint64_t>(entry.size())
                                   .text() +
                               text32("") +
                               Bytes().add<std::uint64_t>(size).add<std::uint64_t>(size).text());
  }
  file << mcap_record(15, Bytes().add<std::uint32_t>(0).text());
  const auto summary = static_cast<std::uint64_t>(file.tellp());
  file
      << described
      << mcap_record(11,
                     Bytes()
                         .add<std::uint64_t>(chunks)
                         .add<std::uint16_t>(1)
                         .add<std::uint32_t>(1)
                         .add<std::uint32_t>(0)
                         .add<std::uint32_t>(0)
                         .add<std::uint32_t>(chunks)
                         .add<std::uint64_t>(stamp_s(0) * 1'000'000'000)
                         .add<std::uint64_t>(stamp_s(chunks - 1) * 1'000'000'000)
                         .add<std::uint32_t>(10)
                         .add<std::uint16_t>(0)
                         .add<std::uint64_t>(chunks)
                         .text())
      << indexes
      << mcap_record(
             2,
             Bytes().add<std::uint64_t>(summary).add<std::uint64_t>(0).add<std::uint32_t>(0).text())
      << magic;
  return path;
}

/// A record of a ROS 1 bag without its data.
std::string bag_head(const std::vector<std::string>& fields, std::uint64_t data_size) {
  std::string header;
  for (const std::string& field : fields) header += text32(field);
  return text32(header) + Bytes().add<std::uint32_t>(static_cast<std::uint32_t>(data_size)).text();
}

std::string number(const std::string& name, std::uint32_t value) {
  return name + "=" + Bytes().add<std::uint32_t>(value).text();
}
std::string number64(const std::string& name, std::uint64_t value) {
  return name + "=" + Bytes().add<std::uint64_t>(value).text();
}
std::string op(char code) {
  return std::string("op=") + code;
}

fs::path sparse_bag(const TempDir& dir) {
  const std::string about = text32("topic=/points") + text32("type=sensor_msgs/PointCloud2") +
                            text32("md5sum=*") + text32("message_definition=");
  const std::string connection =
      bag_head({op(7), number("conn", 0), "topic=/points"}, about.size()) + about;
  const fs::path path = dir.path() / "large.bag";
  std::ofstream file(path, std::ios::binary);
  file.seekp(4117);
  std::string infos;
  for (std::size_t i = 0; i < chunks; ++i) {
    const std::uint64_t time = stamp_s(i);
    const std::string records =
        connection + bag_head({op(2), number("conn", 0), number64("time", time)}, cloud().size()) +
        cloud();
    const std::uint64_t size = i == 0 ? records.size() : chunk_bytes;
    const auto offset = static_cast<std::uint64_t>(file.tellp());
    const std::string head = bag_head(
        {op(5), "compression=none", number("size", static_cast<std::uint32_t>(size))}, size);
    file << head;
    if (i == 0) file << records;
    file.seekp(static_cast<std::streamoff>(offset + head.size() + size));
    file << bag_head({op(4), number("ver", 1), number("conn", 0), number("count", 1)}, 12)
         << Bytes()
                .add<std::uint64_t>(time)
                .add<std::uint32_t>(static_cast<std::uint32_t>(connection.size()))
                .text();
    infos += bag_head({op(6),
                       number("ver", 1),
                       number64("chunk_pos", offset),
                       number64("start_time", time),
                       number64("end_time", time),
                       number("count", 1)},
                      8) +
             Bytes().add<std::uint32_t>(0).add<std::uint32_t>(1).text();
  }
  const auto index = static_cast<std::uint64_t>(file.tellp());
  file << connection << infos;
  file.seekp(0);
  const std::string head = bag_head(
      {op(3), number64("index_pos", index), number("conn_count", 1), number("chunk_count", chunks)},
      0);
  file << "#ROSBAG V2.0\n"
       << bag_head({op(3),
                    number64("index_pos", index),
                    number("conn_count", 1),
                    number("chunk_count", chunks)},
                   4104 - head.size());
  return path;
}

class LargeContainers : public testing::TestWithParam<fs::path (*)(const TempDir&)> {};

TEST_P(LargeContainers, TellFromTheirIndexAlone) {
  const TempDir dir;
  const fs::path path = GetParam()(dir);
  ASSERT_GT(fs::file_size(path), 20'000'000'000U);
  const std::uint64_t before = bytes_read();
  const auto log = open_log(path);
  const LogInfo info = log->info();
  const auto times = log->known_times();
  EXPECT_LT(bytes_read() - before, most_bytes);
  EXPECT_THAT(info.scan_count, Optional(chunks));
  ASSERT_EQ(info.topics.size(), 1U);
  EXPECT_EQ(info.topics[0].name, "/points");
  ASSERT_TRUE(info.time_range.has_value());
  EXPECT_EQ((info.time_range->second - info.time_range->first) / 1'000'000'000, chunks - 1 + 60);
  ASSERT_TRUE(times.has_value());
  ASSERT_EQ(times->size(), chunks);
  for (std::size_t i = 0; i < chunks; ++i) {
    ASSERT_EQ((*times)[i], static_cast<std::int64_t>(stamp_s(i)) * 1'000'000'000) << i;
  }
  const auto first = log->next();
  ASSERT_TRUE(first.has_value());
  EXPECT_EQ(test::scan_of(*first).points.at(0), Eigen::Vector3f(1, 2, 3));
  EXPECT_LT(bytes_read() - before, most_bytes);
}

INSTANTIATE_TEST_SUITE_P(Formats, LargeContainers, testing::Values(sparse_mcap, sparse_bag));

TEST(KnownTimes, OfAFolderAreItsStamps) {
  const TempDir dir;
  for (const char* name :
       {"1700000000000000000.xyz", "1700000000100000000.xyz", "1700000007000000000.xyz"})
    dir.write(name, "1 2 3\n4 5 6\n");
  const auto log = open_log(dir.path());
  EXPECT_THAT(
      log->known_times(),
      Optional(ElementsAre(
          1'700'000'000'000'000'000, 1'700'000'000'100'000'000, 1'700'000'007'000'000'000)));
}

TEST(KnownTimes, OfAFolderWithoutStampsAreNot) {
  const TempDir dir;
  for (const char* name : {"1.xyz", "2.xyz"}) dir.write(name, "1 2 3\n4 5 6\n");
  EXPECT_FALSE(open_log(dir.path())->known_times().has_value());
}

}  // namespace
}  // namespace kissmap
