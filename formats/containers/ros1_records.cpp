// SPDX-License-Identifier: MIT
#include "formats/containers/ros1_records.hpp"

#include <algorithm>

#include "formats/containers/unpack.hpp"

namespace kissmap::ros1 {
namespace {

constexpr std::uint64_t max_header_bytes = 1 << 20;  // of a record; real ones have some hundred

}  // namespace

RecordHeader::RecordHeader(Bytes bytes) {
  ByteCursor cursor(bytes);
  while (cursor.left() > 0) {
    const std::string_view field = cursor.text32();
    const std::size_t equals = field.find('=');
    if (equals == std::string_view::npos) {
      throw Refusal(refusal_reason::broken_content, "a field without '=' in a record's header");
    }
    fields_[field.substr(0, equals)] = field.substr(equals + 1);
  }
}

std::string_view RecordHeader::text(std::string_view name) const {
  const auto found = fields_.find(name);
  if (found == fields_.end()) {
    throw Refusal(refusal_reason::broken_content,
                  "a record without the field '" + std::string(name) + "'");
  }
  return found->second;
}
Record read_record(ByteCursor& cursor) {
  RecordHeader header(cursor.block32());
  return {std::move(header), cursor.block32()};
}

std::int64_t time_of(std::uint64_t packed) {
  return static_cast<std::int64_t>(packed & 0xFFFFFFFFU) * 1'000'000'000 +
         static_cast<std::int64_t>(packed >> 32U);
}

void Connections::add(const Record& record, std::vector<Topic>& topics) {
  const auto number = record.header.number<std::uint32_t>("conn");
  const RecordHeader about(record.data);
  // The topic a connection is recorded under may differ from the one it was made with.
  const std::string name(record.header.has("topic") ? record.header.text("topic")
                                                    : about.text("topic"));
  const std::string type(about.text("type"));
  const auto same = [&](const Topic& topic) { return topic.name == name && topic.type == type; };
  auto topic = std::ranges::find_if(topics, same);
  if (topic == topics.end()) {
    topics.push_back({name, type, MessageEncoding::ros1, std::nullopt});
    topic = topics.end() - 1;
  }
  topic_of_[number] = static_cast<std::size_t>(topic - topics.begin());
}
std::optional<std::size_t> Connections::topic(std::uint32_t number) const {
  const auto found = topic_of_.find(number);
  return found == topic_of_.end() ? std::nullopt : std::optional(found->second);
}

void find_messages(LoadedChunk& chunk, Connections& connections, std::vector<Topic>* topics) {
  ByteCursor cursor(chunk.bytes);
  while (cursor.left() > 0) {
    const Record record = read_record(cursor);
    const std::uint8_t op = record.op();
    if (op == connection && topics != nullptr) connections.add(record, *topics);
    if (op != message_data) continue;
    const auto topic = connections.topic(record.header.number<std::uint32_t>("conn"));
    if (!topic) continue;
    const auto offset = static_cast<std::size_t>(record.data.data() - chunk.bytes.data());
    chunk.messages.push_back(
        {*topic, time_of(record.header.number<std::uint64_t>("time")), offset, record.data.size()});
  }
}

RecordPlace locate_record(const ContainerFile& file,
                          std::uint64_t offset,
                          std::vector<std::byte>& buffer,
                          Bytes& header) {
  ByteCursor lengths(file.read(offset, 4, buffer));
  const std::uint64_t header_size = lengths.value<std::uint32_t>();
  if (header_size > max_header_bytes) {
    throw Refusal(refusal_reason::broken_content, "no record begins here");
  }
  ByteCursor cursor(file.read(offset + 4, header_size + 4, buffer));
  header = cursor.take(header_size);
  const auto data_size = cursor.value<std::uint32_t>();
  return {offset + 8 + header_size, data_size};
}

namespace {

/// What a chunk record says before its records.
struct ChunkHead {
  RecordPlace place;
  Compression compression = Compression::none;
  std::uint64_t size = 0;
};

ChunkHead read_chunk_head(const ContainerFile& file,
                          std::uint64_t offset,
                          std::vector<std::byte>& buffer) {
  Bytes header_bytes;
  const RecordPlace place = locate_record(file, offset, buffer, header_bytes);
  const RecordHeader header(header_bytes);
  return {
      place, compression_named(header.text("compression")), header.number<std::uint32_t>("size")};
}

}  // namespace

void load_chunk(const ContainerFile& file,
                std::uint64_t offset,
                std::vector<std::byte>& buffer,
                std::vector<std::byte>& out) {
  ChunkHead head;
  try {
    head = read_chunk_head(file, offset, buffer);
  } catch (const Refusal&) {
    out.clear();  // of the chunk before
    throw;
  }
  const RecordPlace& place = head.place;
  const bool packed = head.compression != Compression::none;
  // What is not packed is read to where it stays.
  const Bytes there = file.read(place.data_offset, place.data_size, packed ? buffer : out);
  if (packed) {
    unpack(head.compression, there, head.size, out);
  } else {
    out.resize(there.size());
  }
  if (place.end() > file.size()) {
    throw Refusal(refusal_reason::truncated, "the file ends inside of this chunk");
  }
}

}  // namespace kissmap::ros1
