// SPDX-License-Identifier: MIT
#include "formats/containers/mcap.hpp"

#include <zlib.h>

#include <algorithm>
#include <limits>
#include <map>
#include <utility>

#include "formats/containers/byte_cursor.hpp"
#include "formats/containers/chunked_source.hpp"
#include "formats/containers/ros_type.hpp"
#include "formats/containers/unpack.hpp"
#include "formats/text/lines.hpp"
#include "kissmap/error.hpp"

namespace kissmap {
namespace {

using Bytes = std::span<const std::byte>;

constexpr std::string_view magic = "\x89MCAP0\r\n";
constexpr std::uint64_t record_head = 9;  // bytes: opcode and length
constexpr std::uint64_t message_head = 22;
constexpr std::uint64_t footer_size = 20;
constexpr std::uint64_t bare_run_bytes = 4 << 20;  // messages outside of chunks are read so many

enum Op : std::uint8_t {
  footer = 0x02,
  schema = 0x03,
  channel = 0x04,
  message_record = 0x05,
  chunk_record = 0x06,
  message_index = 0x07,
  chunk_index = 0x08,
  statistics = 0x0B,
  data_end = 0x0F
};

struct Record {
  std::uint8_t op = 0;
  Bytes content;
};

Bytes block64(ByteCursor& cursor) {
  return cursor.take(cursor.value<std::uint64_t>());
}

Record read_record(ByteCursor& cursor) {
  const auto op = cursor.value<std::uint8_t>();
  return {op, block64(cursor)};
}

std::int64_t time_of(std::uint64_t ns) {
  constexpr auto most = static_cast<std::uint64_t>(std::numeric_limits<std::int64_t>::max());
  return static_cast<std::int64_t>(std::min(ns, most));
}

MessageEncoding encoding_named(std::string_view name) {
  if (name == "ros1") return MessageEncoding::ros1;
  if (name == "cdr") return MessageEncoding::cdr;
  if (name == "protobuf") return MessageEncoding::protobuf;
  return MessageEncoding::other;
}

/// Schemas and channels by number, and the topics they belong to.
class Channels {
 public:
  void add_schema(Bytes content) {
    ByteCursor cursor(content);
    const auto id = cursor.value<std::uint16_t>();
    schema_names_[id] = std::string(cursor.text32());
  }

  void add_channel(Bytes content, std::vector<Topic>& topics) {
    ByteCursor cursor(content);
    const auto id = cursor.value<std::uint16_t>();
    const auto schema_id = cursor.value<std::uint16_t>();
    Topic found{std::string(cursor.text32()),
                ros_type_name(schema_names_[schema_id]),
                encoding_named(cursor.text32()),
                std::nullopt};
    const auto same = [&](const Topic& topic) {
      return topic.name == found.name && topic.type == found.type &&
             topic.encoding == found.encoding;
    };
    auto topic = std::ranges::find_if(topics, same);
    if (topic == topics.end()) {
      topics.push_back(std::move(found));
      topic = topics.end() - 1;
    }
    topic_of_[id] = static_cast<std::size_t>(topic - topics.begin());
  }

  std::optional<std::size_t> topic(std::uint16_t id) const {
    const auto found = topic_of_.find(id);
    return found == topic_of_.end() ? std::nullopt : std::optional(found->second);
  }

 private:
  std::map<std::uint16_t, std::string> schema_names_;
  std::map<std::uint16_t, std::size_t> topic_of_;
};

/// The messages among records. Topics that appear are added to `topics` where that is given.
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

/// The records inside of a chunk record. `content` may be cut.
void unpack_chunk(Bytes content, std::vector<std::byte>& out) {
  ByteCursor cursor(content);
  cursor.take(16);  // times
  const auto size = cursor.value<std::uint64_t>();
  const auto checksum = cursor.value<std::uint32_t>();
  const Compression compression = compression_named(cursor.text32());
  const auto packed_size = cursor.value<std::uint64_t>();
  const bool cut = packed_size > cursor.left();
  const Bytes packed = cursor.take(std::min<std::uint64_t>(packed_size, cursor.left()));
  if (cut && compression == Compression::none) {
    out.assign(packed.begin(), packed.end());
  } else {
    unpack(compression, packed, size, out);
  }
  if (cut) throw Refusal(refusal_reason::truncated, "the file ends inside of this chunk");
  const auto* bytes = reinterpret_cast<const Bytef*>(out.data());
  if (checksum != 0 && crc32_z(0, bytes, out.size()) != checksum) {
    throw Refusal(refusal_reason::broken_content, "its check sum fails");
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
  const Bytes record = file.read(chunk.offset, chunk.size, buffer);
  ByteCursor head(record);
  if (head.value<std::uint8_t>() != chunk_record) {
    throw Refusal(refusal_reason::broken_content, "no chunk begins here");
  }
  const auto size = head.value<std::uint64_t>();
  unpack_chunk(head.take(std::min<std::uint64_t>(size, head.left())), out);
}

class McapChunkReader : public ChunkReader {
 public:
  McapChunkReader(std::shared_ptr<const ContainerFile> file,
                  Channels channels,
                  std::map<std::uint64_t, std::vector<std::uint64_t>> indexes)
      : file_(std::move(file)), channels_(std::move(channels)), indexes_(std::move(indexes)) {}

  void load(const Chunk& chunk, LoadedChunk& to) override {
    try {
      load_chunk(*file_, chunk, buffer_, to.bytes);
    } catch (const Refusal&) {
      salvage(to);
      throw;
    }
    find_messages(to, channels_, nullptr);
  }

  // By the lengths of the message indexes that follow the chunk.
  void count(Chunk& chunk) override {
    const auto places = indexes_.find(chunk.offset);
    if (places == indexes_.end()) return;
    std::map<std::size_t, std::uint64_t> counts;
    try {
      for (const std::uint64_t place : places->second) {
        ByteCursor cursor(file_->read(place, record_head + 6, buffer_));
        if (cursor.value<std::uint8_t>() != message_index) return;
        cursor.value<std::uint64_t>();
        const auto topic = channels_.topic(cursor.value<std::uint16_t>());
        if (topic) counts[*topic] += cursor.value<std::uint32_t>() / 16;
      }
    } catch (const Refusal&) {
      return;  // unpacking will tell
    }
    chunk.counts = std::move(counts);
  }

 private:
  void salvage(LoadedChunk& to) {
    try {
      find_messages(to, channels_, nullptr);
    } catch (const Refusal&) {
      // The cut goes through a record: what came before it was found.
    }
  }

  std::shared_ptr<const ContainerFile> file_;
  Channels channels_;
  std::map<std::uint64_t, std::vector<std::uint64_t>> indexes_;  // of messages, by chunk
  std::vector<std::byte> buffer_;
};

/// What is found out while a file is opened.
struct Opening {
  std::shared_ptr<const ContainerFile> file;
  ContainerIndex index;
  Channels channels;
  std::map<std::uint64_t, std::vector<std::uint64_t>> indexes;
  std::optional<std::uint64_t> messages_told;  // by the statistics
};

void add_chunk_index(Bytes content, Opening& mcap) {
  ByteCursor cursor(content);
  Chunk chunk;
  chunk.first_ns = time_of(cursor.value<std::uint64_t>());
  chunk.last_ns = time_of(cursor.value<std::uint64_t>());
  chunk.offset = cursor.value<std::uint64_t>();
  chunk.size = cursor.value<std::uint64_t>();
  ByteCursor offsets(cursor.block32());
  auto& places = mcap.indexes[chunk.offset];
  while (offsets.left() > 0) {
    offsets.value<std::uint16_t>();
    places.push_back(offsets.value<std::uint64_t>());
  }
  if (places.empty()) mcap.indexes.erase(chunk.offset);
  if (chunk.offset > mcap.file->size() || chunk.size > mcap.file->size() - chunk.offset) {
    throw Refusal(refusal_reason::broken_content, "the summary names a chunk beyond the file");
  }
  mcap.index.chunks.push_back(std::move(chunk));
}

void add_statistics(Bytes content, Opening& mcap) {
  ByteCursor cursor(content);
  mcap.messages_told = cursor.value<std::uint64_t>();
  cursor.take(2 + 4 * 4);
  const std::int64_t first = time_of(cursor.value<std::uint64_t>());
  const std::int64_t last = time_of(cursor.value<std::uint64_t>());
  if (mcap.messages_told > 0U) mcap.index.time_range.emplace(first, last);
  for (Topic& topic : mcap.index.topics) topic.message_count = 0;
  ByteCursor counts(cursor.block32());
  while (counts.left() > 0) {
    const auto topic = mcap.channels.topic(counts.value<std::uint16_t>());
    const auto count = counts.value<std::uint64_t>();
    if (topic) *mcap.index.topics[*topic].message_count += count;
  }
}

void read_summary(Bytes summary, Opening& mcap) {
  // Statistics count by channel, and may stand before the channels.
  std::vector<Bytes> statistics_records;
  ByteCursor cursor(summary);
  while (cursor.left() > 0) {
    const Record record = read_record(cursor);
    if (record.op == schema) mcap.channels.add_schema(record.content);
    if (record.op == channel) mcap.channels.add_channel(record.content, mcap.index.topics);
    if (record.op == chunk_index) add_chunk_index(record.content, mcap);
    if (record.op == statistics) statistics_records.push_back(record.content);
  }
  for (const Bytes record : statistics_records) add_statistics(record, mcap);
}

/// True where the summary tells all that is needed.
bool use_summary(Opening& mcap) {
  const std::uint64_t tail = record_head + footer_size + magic.size();
  if (mcap.file->size() < magic.size() + tail) return false;
  std::vector<std::byte> buffer;
  const std::uint64_t footer_offset = mcap.file->size() - tail;
  ByteCursor cursor(mcap.file->read(footer_offset, tail, buffer));
  const Record record = read_record(cursor);
  if (record.op != footer || text_of(cursor.take(cursor.left())) != magic) return false;
  ByteCursor fields(record.content);
  const auto start = fields.value<std::uint64_t>();
  if (start == 0 || start > footer_offset) return false;
  std::vector<std::byte> summary;
  read_summary(mcap.file->read(start, footer_offset - start, summary), mcap);
  // Messages outside of chunks have no index: only looking finds them.
  return !mcap.index.chunks.empty() ||
         (mcap.index.time_range == std::nullopt && !mcap.index.topics.empty() &&
          mcap.messages_told == 0 && mcap.index.topics[0].message_count.has_value());
}

/// Counts what a file without a summary holds, chunk by chunk.
class Survey {
 public:
  explicit Survey(Opening& mcap) : mcap_(mcap) {}

  void run() {
    std::uint64_t offset = magic.size();
    const std::uint64_t size = mcap_.file->size();
    try {
      while (offset < size) {
        ByteCursor head(mcap_.file->read(offset, record_head + message_head, buffer_));
        const auto op = head.value<std::uint8_t>();
        const auto length = head.value<std::uint64_t>();
        const bool whole = length <= size - std::min(size, offset + record_head);
        if (op == data_end || op == footer) return finish_run();
        if (op == chunk_record) {
          look_through_chunk(offset, std::min(length, size) + record_head);
          if (!whole) return;  // the chunk reports it when it is read
        } else if (!whole) {
          throw Refusal(refusal_reason::truncated, "the file ends inside of a record");
        } else if (op == message_record) {
          add_bare_message(offset, length, head);
        } else if (op == schema || op == channel) {
          add_definition(op, mcap_.file->read(offset + record_head, length, buffer_));
        }
        offset += record_head + length;
      }
      throw Refusal(refusal_reason::truncated, "the file ends without the mark of its end");
    } catch (const Refusal& refusal) {
      finish_run();
      mcap_.index.damage.push_back({refusal.reason(),
                                    mcap_.file->path().string() + ": at byte " +
                                        std::to_string(offset) + ": " + refusal.what() +
                                        "; what came before is read"});
    }
  }

 private:
  void add_definition(std::uint8_t op, Bytes content) {
    if (op == schema) mcap_.channels.add_schema(content);
    if (op == channel) mcap_.channels.add_channel(content, mcap_.index.topics);
  }

  void count(Chunk& chunk, std::size_t topic, std::int64_t logged_ns) {
    if (!chunk.counts) chunk.counts.emplace();
    if (chunk.counts->empty()) chunk.first_ns = chunk.last_ns = logged_ns;
    ++(*chunk.counts)[topic];
    chunk.first_ns = std::min(chunk.first_ns, logged_ns);
    chunk.last_ns = std::max(chunk.last_ns, logged_ns);
  }

  void add_bare_message(std::uint64_t offset, std::uint64_t length, ByteCursor& head) {
    const auto topic = mcap_.channels.topic(head.value<std::uint16_t>());
    head.value<std::uint32_t>();
    const std::int64_t logged_ns = time_of(head.value<std::uint64_t>());
    if (!topic) return;
    const std::uint64_t end = offset + record_head + length;
    if (run_.size > 0 && end - run_.offset > bare_run_bytes) finish_run();
    if (run_.size == 0) {
      run_.offset = offset;
      run_.bare = true;
    }
    run_.size = end - run_.offset;
    count(run_, *topic, logged_ns);
  }

  void finish_run() {
    if (run_.size > 0) mcap_.index.chunks.push_back(std::exchange(run_, Chunk()));
  }

  void look_through_chunk(std::uint64_t offset, std::uint64_t size) {
    finish_run();
    Chunk chunk;
    chunk.offset = offset;
    chunk.size = size;
    std::optional<Refusal> damage;
    try {
      load_chunk(*mcap_.file, chunk, buffer_, loaded_.bytes);
    } catch (const Refusal& refusal) {
      damage = refusal;
    }
    loaded_.messages.clear();
    try {
      find_messages(loaded_, mcap_.channels, &mcap_.index.topics);
    } catch (const Refusal& refusal) {
      if (!damage) damage = refusal;
    }
    for (const StoredMessage& message : loaded_.messages) {
      count(chunk, message.topic, message.received_ns);
    }
    if (chunk.counts) {
      mcap_.index.chunks.push_back(std::move(chunk));
    } else if (damage) {
      throw Refusal(*damage);
    }
  }

  Opening& mcap_;
  Chunk run_;  // messages outside of chunks, one behind the other; of no size if there is none
  LoadedChunk loaded_;
  std::vector<std::byte> buffer_;
};

}  // namespace

std::unique_ptr<MessageSource> open_mcap(const std::filesystem::path& path) {
  Opening mcap;
  mcap.file = std::make_shared<ContainerFile>(path);
  std::vector<std::byte> buffer;
  if (text_of(mcap.file->read(0, magic.size(), buffer)) != magic) {
    throw input_error(path,
                      mcap.file->size() == 0 ? "has 0 bytes; copy it anew" : "is not an MCAP file");
  }
  bool summarised = false;
  try {
    summarised = use_summary(mcap);
  } catch (const Refusal&) {
    // Looked through below.
  }
  if (!summarised) {
    mcap = Opening{mcap.file, {}, {}, {}, {}};
    mcap.index.notes.push_back(path.filename().string() +
                               " has no summary of its chunks: looked through as a whole");
    Survey(mcap).run();
    sum_counts(mcap.index);
  }
  auto reader = std::make_unique<McapChunkReader>(
      mcap.file, std::move(mcap.channels), std::move(mcap.indexes));
  return std::make_unique<ChunkedSource>(mcap.file, std::move(mcap.index), std::move(reader));
}

}  // namespace kissmap
