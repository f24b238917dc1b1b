// SPDX-License-Identifier: MIT
#include "formats/containers/mcap_records.hpp"

#include <libdeflate.h>

#include <algorithm>
#include <limits>

#include "formats/containers/ros_type.hpp"
#include "formats/containers/unpack.hpp"

namespace kissmap::mcap {
namespace {

Bytes block64(ByteCursor& cursor) {
  return cursor.take(cursor.value<std::uint64_t>());
}

MessageEncoding encoding_named(std::string_view name) {
  if (name == "ros1") return MessageEncoding::ros1;
  if (name == "cdr") return MessageEncoding::cdr;
  if (name == "protobuf") return MessageEncoding::protobuf;
  return MessageEncoding::other;
}

// Beyond it no name of a compression reaches.
constexpr std::uint64_t most_head_bytes = 256;

/// What a chunk record says before its records.
struct ChunkHead {
  std::uint64_t bytes = 0;  ///< from the start of the record to the records in it
  std::uint64_t there = 0;  ///< of packed_size; fewer where the record is cut
  std::uint64_t packed_size = 0;
  std::uint64_t size = 0;
  std::uint32_t checksum = 0;  ///< 0: none
  Compression compression = Compression::none;
};

ChunkHead read_chunk_head(const ContainerFile& file,
                          const Chunk& chunk,
                          std::vector<std::byte>& buffer) {
  ByteCursor cursor(file.read(chunk.offset, std::min(chunk.size, most_head_bytes), buffer));
  if (cursor.value<std::uint8_t>() != chunk_record) {
    throw Refusal(refusal_reason::broken_content, "no chunk begins here");
  }
  const auto length = std::min(cursor.value<std::uint64_t>(), chunk.size);
  cursor.take(16);  // times
  ChunkHead head;
  head.size = cursor.value<std::uint64_t>();
  head.checksum = cursor.value<std::uint32_t>();
  head.compression = compression_named(cursor.text32());
  head.packed_size = cursor.value<std::uint64_t>();
  head.bytes = cursor.position();
  const std::uint64_t end = std::min(record_head + length, chunk.size);
  head.there = std::min(head.packed_size, end - std::min(end, head.bytes));
  if (head.there > max_unpacked_bytes) {
    throw Refusal(refusal_reason::too_large, "a chunk of " + std::to_string(head.there) + " bytes");
  }
  return head;
}

bool keeps(std::uint32_t checksum, Bytes records) {
  return checksum == 0 || libdeflate_crc32(0, records.data(), records.size()) == checksum;
}

}  // namespace

Record read_record(ByteCursor& cursor) {
  const auto op = cursor.value<std::uint8_t>();
  return {op, block64(cursor)};
}

std::int64_t time_of(std::uint64_t ns) {
  constexpr auto most = static_cast<std::uint64_t>(std::numeric_limits<std::int64_t>::max());
  return static_cast<std::int64_t>(std::min(ns, most));
}

void Channels::add_schema(Bytes content) {
  ByteCursor cursor(content);
  const auto id = cursor.value<std::uint16_t>();
  schema_names_[id] = std::string(cursor.text32());
}

void Channels::add_channel(Bytes content, std::vector<Topic>& topics) {
  ByteCursor cursor(content);
  const auto id = cursor.value<std::uint16_t>();
  const auto schema_id = cursor.value<std::uint16_t>();
  Topic found{std::string(cursor.text32()),
              ros_type_name(schema_names_[schema_id]),
              encoding_named(cursor.text32()),
              std::nullopt};
  const auto same = [&](const Topic& topic) {
    return topic.name == found.name && topic.type == found.type && topic.encoding == found.encoding;
  };
  auto topic = std::ranges::find_if(topics, same);
  if (topic == topics.end()) {
    topics.push_back(std::move(found));
    topic = topics.end() - 1;
  }
  topic_of_[id] = static_cast<std::size_t>(topic - topics.begin());
}

std::optional<std::size_t> Channels::topic(std::uint16_t id) const {
  const auto found = topic_of_.find(id);
  return found == topic_of_.end() ? std::nullopt : std::optional(found->second);
}

void find_messages(LoadedChunk& chunk, Channels& channels, std::vector<Topic>* topics) {
  ByteCursor cursor(chunk.bytes);
  while (cursor.left() > 0) {
    const Record record = read_record(cursor);
    if (topics != nullptr && record.op == schema) channels.add_schema(record.content);
    if (topics != nullptr && record.op == channel) channels.add_channel(record.content, *topics);
    if (record.op != message_record) continue;
    ByteCursor fields(record.content);
    const auto topic = channels.topic(fields.value<std::uint16_t>());
    fields.value<std::uint32_t>();  // sequence
    const std::int64_t logged_ns = time_of(fields.value<std::uint64_t>());
    fields.value<std::uint64_t>();  // published
    const Bytes data = fields.take(fields.left());
    if (!topic) continue;
    const auto offset = static_cast<std::size_t>(data.data() - chunk.bytes.data());
    chunk.messages.push_back({*topic, logged_ns, offset, data.size()});
  }
}

void load_chunk(const ContainerFile& file,
                const Chunk& chunk,
                std::vector<std::byte>& buffer,
                std::vector<std::byte>& out) {
  if (chunk.bare) {
    const Bytes there = file.read(chunk.offset, chunk.size, out);
    out.resize(there.size());
    return;
  }
  ChunkHead head;
  try {
    head = read_chunk_head(file, chunk, buffer);
  } catch (const Refusal&) {
    out.clear();  // of the chunk before
    throw;
  }
  const std::uint64_t offset = chunk.offset + head.bytes;
  const bool packed = head.compression != Compression::none;
  // What is not packed is read to where it stays.
  const Bytes there = file.read(offset, head.there, packed ? buffer : out);
  const bool cut = there.size() < head.packed_size;
  if (packed) {
    unpack(head.compression, there, head.size, out);
  } else {
    out.resize(there.size());
  }
  if (cut) throw Refusal(refusal_reason::truncated, "the file ends inside of this chunk");
  if (out.size() != head.size) {
    throw Refusal(refusal_reason::wrong_size,
                  std::to_string(out.size()) + " bytes instead of " + std::to_string(head.size));
  }
  if (!keeps(head.checksum, out)) {
    out.clear();  // which of the messages is damaged is not known
    throw Refusal(refusal_reason::broken_content, "its check sum fails");
  }
}

}  // namespace kissmap::mcap
