// SPDX-License-Identifier: MIT
// Writes containers of 20 GB that are holes but for their first chunk and their index.
#pragma once

#include <gtest/gtest.h>

#include <fstream>

#include "formats/support.hpp"

namespace kissmap::test::sparse {

inline constexpr std::size_t chunks = 5000;
inline constexpr std::uint64_t chunk_bytes = 4 << 20;
inline constexpr std::size_t pause_before = 3000;  // chunk
inline constexpr std::uint64_t most_bytes = 64 << 20;

inline std::uint64_t stamp_s(std::size_t chunk) {
  return 1'700'000'000 + chunk + (chunk >= pause_before ? 60 : 0);
}

/// Where a container says its index stands.
enum class IndexPlace : std::uint8_t { true_one, first_record, hole };

inline std::uint64_t told_place(IndexPlace place, std::uint64_t index, std::uint64_t first_record) {
  if (place == IndexPlace::first_record) return first_record;
  return place == IndexPlace::hole ? 10 * chunk_bytes : index;
}

/// Bytes this process has asked the kernel for.
inline std::uint64_t bytes_read() {
  std::ifstream io("/proc/self/io");
  std::string name;
  std::uint64_t count = 0;
  io >> name >> count;
  EXPECT_EQ(name, "rchar:");
  return count;
}

inline std::string text32(const std::string& text) {
  return Bytes().add<std::uint32_t>(static_cast<std::uint32_t>(text.size())).text() + text;
}

/// sensor_msgs/PointCloud2 of ROS 1 with one point.
inline std::string cloud() {
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

inline std::string mcap_record(std::uint8_t op, const std::string& content) {
  return Bytes().add<std::uint8_t>(op).add<std::uint64_t>(content.size()).text() + content;
}

inline fs::path mcap(const TempDir& dir, IndexPlace place) {
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
  const auto summary = told_place(place, static_cast<std::uint64_t>(file.tellp()), magic.size());
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
inline std::string bag_head(const std::vector<std::string>& fields, std::uint64_t data_size) {
  std::string header;
  for (const std::string& field : fields) header += text32(field);
  return text32(header) + Bytes().add<std::uint32_t>(static_cast<std::uint32_t>(data_size)).text();
}

inline std::string number(const std::string& name, std::uint32_t value) {
  return name + "=" + Bytes().add<std::uint32_t>(value).text();
}
inline std::string number64(const std::string& name, std::uint64_t value) {
  return name + "=" + Bytes().add<std::uint64_t>(value).text();
}
inline std::string op(char code) {
  return std::string("op=") + code;
}

inline fs::path bag(const TempDir& dir, IndexPlace place) {
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
  const auto index = told_place(place, static_cast<std::uint64_t>(file.tellp()), 4117);
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

}  // namespace kissmap::test::sparse
