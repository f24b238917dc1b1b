// SPDX-License-Identifier: MIT
#include <algorithm>
#include <utility>

#include "formats/containers/file_window.hpp"
#include "formats/containers/mcap_records.hpp"
#include "formats/text/lines.hpp"

namespace kissmap::mcap {
namespace {

constexpr std::uint64_t footer_size = 20;
constexpr std::uint64_t most_record_bytes = 16 << 20;  // a schema has some kB
// Records that never stand in a summary, and mean nothing here elsewhere.
constexpr std::uint8_t attachment = 0x09;
constexpr std::uint8_t metadata = 0x0C;

void add_chunk_index(Bytes content, Opening& opening) {
  ByteCursor cursor(content);
  Chunk chunk;
  chunk.first_ns = time_of(cursor.value<std::uint64_t>());
  chunk.last_ns = time_of(cursor.value<std::uint64_t>());
  chunk.offset = cursor.value<std::uint64_t>();
  chunk.size = cursor.value<std::uint64_t>();
  ByteCursor offsets(cursor.block32());
  auto& places = opening.indexes[chunk.offset];
  while (offsets.left() > 0) {
    offsets.value<std::uint16_t>();
    places.push_back(offsets.value<std::uint64_t>());
  }
  if (places.empty()) opening.indexes.erase(chunk.offset);
  if (chunk.offset > opening.file->size() || chunk.size > opening.file->size() - chunk.offset) {
    throw Refusal(refusal_reason::broken_content, "the summary names a chunk beyond the file");
  }
  opening.index.chunks.push_back(std::move(chunk));
}

void add_statistics(Bytes content, Opening& opening) {
  ByteCursor cursor(content);
  opening.messages_told = cursor.value<std::uint64_t>();
  cursor.take(2 + 4 * 4);
  const std::int64_t first = time_of(cursor.value<std::uint64_t>());
  const std::int64_t last = time_of(cursor.value<std::uint64_t>());
  if (opening.messages_told > 0U) opening.index.time_range.emplace(first, last);
  for (Topic& topic : opening.index.topics) topic.message_count = 0;
  ByteCursor counts(cursor.block32());
  while (counts.left() > 0) {
    const auto topic = opening.channels.topic(counts.value<std::uint16_t>());
    const auto count = counts.value<std::uint64_t>();
    if (topic) *opening.index.topics[*topic].message_count += count;
  }
}

/// A record's opcode and the length of its content. Throws Refusal for one that has no place in a
/// summary: where its offset is wrong, what stands there may be as large as the file.
std::pair<std::uint8_t, std::uint64_t> read_head(Bytes bytes, std::uint64_t left) {
  ByteCursor head(bytes);
  const auto op = head.value<std::uint8_t>();
  const auto length = head.value<std::uint64_t>();
  const bool of_data = op == 0 || op == header || op == footer || op == message_record ||
                       op == chunk_record || op == message_index || op == attachment ||
                       op == metadata || op == data_end;
  if (of_data || length > left) {
    throw Refusal(refusal_reason::broken_content, "no record of a summary begins here");
  }
  return {op, length};
}

void read_summary(Opening& opening, std::uint64_t offset, std::uint64_t end) {
  FileWindow window(*opening.file);
  // Statistics count by channel, and may stand before the channels.
  std::vector<std::byte> about_all;
  while (offset < end) {
    const auto [op, length] = read_head(window.at(offset, std::min(record_head, end - offset)),
                                        end - std::min(end, offset + record_head));
    offset += record_head;
    if (op == schema || op == channel || op == chunk_index || op == statistics) {
      if (length > most_record_bytes) {
        throw Refusal(refusal_reason::broken_content, "a record of the summary is too long");
      }
      const Bytes content = window.at(offset, length);
      if (op == schema) opening.channels.add_schema(content);
      if (op == channel) opening.channels.add_channel(content, opening.index.topics);
      if (op == chunk_index) add_chunk_index(content, opening);
      if (op == statistics) about_all.assign(content.begin(), content.end());
    }
    offset += length;
  }
  if (!about_all.empty()) add_statistics(about_all, opening);
}

}  // namespace

bool use_summary(Opening& opening) {
  const std::uint64_t tail = record_head + footer_size + magic.size();
  if (opening.file->size() < magic.size() + tail) return false;
  std::vector<std::byte> buffer;
  const std::uint64_t footer_offset = opening.file->size() - tail;
  ByteCursor cursor(opening.file->read(footer_offset, tail, buffer));
  const Record record = read_record(cursor);
  if (record.op != footer || text_of(cursor.take(cursor.left())) != magic) return false;
  ByteCursor fields(record.content);
  const auto start = fields.value<std::uint64_t>();
  if (start == 0 || start > footer_offset) return false;
  read_summary(opening, start, footer_offset);
  // Messages outside of chunks have no index: only looking finds them.
  return !opening.index.chunks.empty() ||
         (opening.index.time_range == std::nullopt && !opening.index.topics.empty() &&
          opening.messages_told == 0 && opening.index.topics[0].message_count.has_value());
}

}  // namespace kissmap::mcap
