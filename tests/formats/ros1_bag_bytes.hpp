// SPDX-License-Identifier: MIT
// Writes ROS 1 bags of version 2.0 byte by byte (wiki.ros.org/Bags/Format/2.0), uncompressed.
#pragma once

#include <map>
#include <string>
#include <utility>
#include <vector>

#include "formats/message_bytes.hpp"

namespace kissmap::test {

/// A topic as one publisher of it announced it.
struct BagConnection {
  std::uint32_t number = 0;
  std::string topic;
  std::string type;
};

struct BagMessage {
  std::uint32_t connection = 0;
  std::uint32_t seconds = 0;
  std::uint32_t nanoseconds = 0;
  std::string data;
};
using BagChunk = std::vector<BagMessage>;

class Ros1BagBytes {
 public:
  Ros1BagBytes(std::vector<BagConnection> connections, const std::vector<BagChunk>& chunks)
      : connections_(std::move(connections)) {
    for (const BagChunk& chunk : chunks) add(chunk);
  }

  /// As it is when it was closed.
  std::string closed() const {
    std::string index;
    for (const BagConnection& connection : connections_) index += announced(connection);
    return begun(first_record + chunks_.size()) + chunks_ + index + infos_;
  }
  /// As a recorder leaves it that was killed: without an index.
  std::string open() const { return begun(0) + chunks_; }

  static constexpr std::size_t first_record = 4117;  // 13 bytes of a name, 8 and 4096 of a record

 private:
  static std::string u32(std::size_t value) {
    return little<std::uint32_t>(static_cast<std::uint32_t>(value));
  }
  static std::string block(const std::string& bytes) { return u32(bytes.size()) + bytes; }
  static std::string field(const std::string& name, const std::string& value) {
    return block(name + "=" + value);
  }
  static std::string record(char op, const std::string& fields, const std::string& data) {
    return block(field("op", std::string(1, op)) + fields) + block(data);
  }
  static std::string time(const BagMessage& message) {
    return u32(message.seconds) + u32(message.nanoseconds);
  }
  static std::string announced(const BagConnection& connection) {
    return record(7,
                  field("conn", u32(connection.number)) + field("topic", connection.topic),
                  field("topic", connection.topic) + field("type", connection.type) +
                      field("md5sum", "*") + field("message_definition", ""));
  }

  std::string begun(std::size_t index) const {
    const bool closed = index > 0;
    const std::string fields = field("index_pos", little<std::uint64_t>(index)) +
                               field("conn_count", u32(closed ? connections_.size() : 0)) +
                               field("chunk_count", u32(closed ? chunk_count_ : 0));
    const std::string unpadded = record(3, fields, "");
    return "#ROSBAG V2.0\n" + record(3, fields, std::string(4104 - unpadded.size(), ' '));
  }

  void add(const BagChunk& chunk) {
    std::string records;
    std::map<std::uint32_t, std::string> entries;
    for (const BagConnection& connection : connections_) {
      for (const BagMessage& message : chunk) {
        if (message.connection != connection.number || announced_[connection.number]) continue;
        records += announced(connection);
        announced_[connection.number] = true;
      }
    }
    for (const BagMessage& message : chunk) {
      entries[message.connection] += time(message) + u32(records.size());
      records += record(
          2, field("conn", u32(message.connection)) + field("time", time(message)), message.data);
    }
    const std::string place = little<std::uint64_t>(first_record + chunks_.size());
    chunks_ +=
        record(5, field("compression", "none") + field("size", u32(records.size())), records);
    std::string counts;
    for (const auto& [connection, places] : entries) {
      const std::string count = u32(places.size() / 12);
      chunks_ += record(
          4, field("ver", u32(1)) + field("conn", u32(connection)) + field("count", count), places);
      counts += u32(connection) + count;
    }
    infos_ +=
        record(6,
               field("ver", u32(1)) + field("chunk_pos", place) +
                   field("start_time", time(chunk.front())) +
                   field("end_time", time(chunk.back())) + field("count", u32(entries.size())),
               counts);
    ++chunk_count_;
  }

  std::vector<BagConnection> connections_;
  std::map<std::uint32_t, bool> announced_;
  std::string chunks_;
  std::string infos_;
  std::size_t chunk_count_ = 0;
};

}  // namespace kissmap::test
