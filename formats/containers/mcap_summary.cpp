// SPDX-License-Identifier: MIT
#include "formats/containers/mcap_records.hpp"
#include "formats/text/lines.hpp"

namespace kissmap::mcap {
namespace {

constexpr std::uint64_t footer_size = 20;

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

void read_summary(Bytes summary, Opening& opening) {
  // Statistics count by channel, and may stand before the channels.
  std::vector<Bytes> statistics_records;
  ByteCursor cursor(summary);
  while (cursor.left() > 0) {
    const Record record = read_record(cursor);
    if (record.op == schema) opening.channels.add_schema(record.content);
    if (record.op == channel) opening.channels.add_channel(record.content, opening.index.topics);
    if (record.op == chunk_index) add_chunk_index(record.content, opening);
    if (record.op == statistics) statistics_records.push_back(record.content);
  }
  for (const Bytes record : statistics_records) add_statistics(record, opening);
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
  std::vector<std::byte> summary;
  read_summary(opening.file->read(start, footer_offset - start, summary), opening);
  // Messages outside of chunks have no index: only looking finds them.
  return !opening.index.chunks.empty() ||
         (opening.index.time_range == std::nullopt && !opening.index.topics.empty() &&
          opening.messages_told == 0 && opening.index.topics[0].message_count.has_value());
}

}  // namespace kissmap::mcap
