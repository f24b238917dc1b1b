// SPDX-License-Identifier: MIT
#pragma once

#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "formats/containers/byte_cursor.hpp"
#include "formats/containers/chunked_source.hpp"

/// Records of ROS 1 bags (wiki.ros.org/Bags/Format/2.0), for ros1_bag.cpp alone. All that reads
/// throws Refusal where the bytes end or contradict the format.
namespace kissmap::ros1 {

using Bytes = std::span<const std::byte>;

enum Op : std::uint8_t {
  message_data = 0x02,
  bag_header = 0x03,
  index_data = 0x04,
  chunk_record = 0x05,
  chunk_info = 0x06,
  connection = 0x07
};

/// The fields name=value at the head of a record. Keeps views of the bytes.
class RecordHeader {
 public:
  explicit RecordHeader(Bytes bytes);

  bool has(std::string_view name) const { return fields_.contains(name); }
  std::string_view text(std::string_view name) const;

  template <class T>
  T number(std::string_view name) const {
    const std::string_view bytes = text(name);
    return ByteCursor(std::as_bytes(std::span(bytes))).value<T>();
  }

 private:
  std::map<std::string_view, std::string_view> fields_;
};

struct Record {
  RecordHeader header;
  Bytes data;
  std::uint8_t op() const { return header.number<std::uint8_t>("op"); }
};

Record read_record(ByteCursor& cursor);
std::int64_t time_of(std::uint64_t packed);

/// Connections by number, and the topics they belong to.
class Connections {
 public:
  void add(const Record& record, std::vector<Topic>& topics);
  std::optional<std::size_t> topic(std::uint32_t number) const;

 private:
  std::map<std::uint32_t, std::size_t> topic_of_;
};

/// Finds the messages among the records of a chunk. Topics that appear are added to `topics` where
/// that is given; messages of unknown connections are left out.
void find_messages(LoadedChunk& chunk, Connections& connections, std::vector<Topic>* topics);

/// Where a record lies in the file.
struct RecordPlace {
  std::uint64_t data_offset = 0;
  std::uint64_t data_size = 0;  ///< as the record says, which may be more than is left
  std::uint64_t end() const { return data_offset + data_size; }
};

/// Reads header and length of the record at `offset`; its header's bytes stay in `buffer`.
RecordPlace locate_record(const ContainerFile& file,
                          std::uint64_t offset,
                          std::vector<std::byte>& buffer,
                          Bytes& header);

/// The records of a chunk, or what can be had of them before a Refusal.
void load_chunk(const ContainerFile& file,
                std::uint64_t offset,
                std::vector<std::byte>& buffer,
                std::vector<std::byte>& out);

}  // namespace kissmap::ros1
