// SPDX-License-Identifier: MIT
#include "formats/containers/ros1_bag.hpp"

#include <algorithm>
#include <limits>

#include "formats/containers/file_window.hpp"
#include "formats/containers/ros1_records.hpp"
#include "formats/containers/unpack.hpp"
#include "formats/text/lines.hpp"
#include "kissmap/error.hpp"

namespace kissmap {
namespace {

using namespace ros1;

constexpr std::string_view magic = "#ROSBAG V2.0\n";
constexpr std::uint64_t most_index_record_bytes = 16 << 20;  // a message's definition has some kB

class Ros1ChunkReader : public ChunkReader {
 public:
  Ros1ChunkReader(std::shared_ptr<const ContainerFile> file, Connections connections)
      : file_(std::move(file)), connections_(std::move(connections)) {}

  void load(const Chunk& chunk, LoadedChunk& to) override {
    try {
      load_chunk(*file_, chunk.offset, buffer_, to.bytes);
    } catch (const Refusal&) {
      salvage(to);
      throw;
    }
    find_messages(to, connections_, nullptr);
  }
  void count(Chunk&) override {}

  // By the index records that follow the chunk, one for each of its connections.
  bool append_times(const Chunk& chunk,
                    std::size_t topic,
                    std::vector<std::int64_t>& to,
                    std::uint64_t& most_bytes) override {
    try {
      Bytes header;
      std::uint64_t place = locate_record(*file_, chunk.offset, buffer_, header).end();
      while (place < file_->size()) {
        const RecordPlace record = locate_record(*file_, place, buffer_, header);
        const RecordHeader fields(header);
        if (fields.number<std::uint8_t>("op") != index_data) return true;
        if (record.end() - place > most_bytes) return false;
        most_bytes -= record.end() - place;
        if (connections_.topic(fields.number<std::uint32_t>("conn")) == topic) {
          append_entries(record, to);
        }
        place = record.end();
      }
    } catch (const Refusal&) {
      return false;
    }
    return true;
  }

 private:
  void append_entries(const RecordPlace& record, std::vector<std::int64_t>& to) {
    ByteCursor entries(file_->read(record.data_offset, record.data_size, buffer_));
    while (entries.left() > 0) {
      to.push_back(time_of(entries.value<std::uint64_t>()));
      entries.value<std::uint32_t>();
    }
  }

  void salvage(LoadedChunk& to) {
    try {
      find_messages(to, connections_, nullptr);
    } catch (const Refusal&) {
      // The cut goes through a record: what came before it was found.
    }
  }

  std::shared_ptr<const ContainerFile> file_;
  Connections connections_;
  std::vector<std::byte> buffer_;
};

/// What is found out while a bag is opened.
struct Opening {
  std::shared_ptr<const ContainerFile> file;
  ContainerIndex index;
  Connections connections;
};

void add_chunk_info(const Record& record, Opening& bag) {
  Chunk chunk;
  chunk.offset = record.header.number<std::uint64_t>("chunk_pos");
  chunk.first_ns = time_of(record.header.number<std::uint64_t>("start_time"));
  chunk.last_ns = time_of(record.header.number<std::uint64_t>("end_time"));
  chunk.counts.emplace();
  ByteCursor counts(record.data);
  for (auto left = record.header.number<std::uint32_t>("count"); left > 0; --left) {
    const auto topic = bag.connections.topic(counts.value<std::uint32_t>());
    const auto messages = counts.value<std::uint32_t>();
    if (topic) (*chunk.counts)[*topic] += messages;
  }
  bag.index.chunks.push_back(std::move(chunk));
}

// The whole of a record of the index, and nothing of any other: where the place of the index is
// wrong, what stands there may be as large as the file.
Bytes index_record(FileWindow& window, std::uint64_t offset) {
  const auto length_at = [&](std::uint64_t at) {
    return std::uint64_t{ByteCursor(window.at(at, 4)).value<std::uint32_t>()};
  };
  const std::uint64_t header_size = length_at(offset);
  if (header_size > most_index_record_bytes) {
    throw Refusal(refusal_reason::broken_content, "no record of an index begins here");
  }
  const RecordHeader header(ByteCursor(window.at(offset + 4, header_size)).take(header_size));
  const auto op = header.number<std::uint8_t>("op");
  const std::uint64_t data_size = length_at(offset + 4 + header_size);
  if ((op != connection && op != chunk_info) || data_size > most_index_record_bytes) {
    throw Refusal(refusal_reason::broken_content, "no record of an index begins here");
  }
  return window.at(offset, 8 + header_size + data_size);
}

// Connections and chunk infos stand at the end, in this order.
void read_index(Opening& bag, std::uint64_t offset, std::uint64_t chunk_count) {
  FileWindow window(*bag.file);
  while (offset < bag.file->size() && bag.index.chunks.size() <= chunk_count) {
    ByteCursor cursor(index_record(window, offset));
    const Record record = read_record(cursor);
    if (record.op() == connection) bag.connections.add(record, bag.index.topics);
    if (record.op() == chunk_info) add_chunk_info(record, bag);
    offset += cursor.position();
  }
  if (bag.index.chunks.size() != chunk_count) {
    throw Refusal(refusal_reason::truncated, "the index is not complete");
  }
}

void look_through_chunk(Opening& bag, std::uint64_t offset, LoadedChunk& loaded) {
  std::vector<std::byte> buffer;
  std::optional<Refusal> damage;
  try {
    load_chunk(*bag.file, offset, buffer, loaded.bytes);
  } catch (const Refusal& refusal) {
    damage = refusal;
  }
  loaded.messages.clear();
  try {
    find_messages(loaded, bag.connections, &bag.index.topics);
  } catch (const Refusal& refusal) {
    if (!damage) damage = refusal;
  }
  Chunk chunk;
  chunk.offset = offset;
  chunk.first_ns = std::numeric_limits<std::int64_t>::max();
  chunk.last_ns = std::numeric_limits<std::int64_t>::min();
  chunk.counts.emplace();
  for (const StoredMessage& message : loaded.messages) {
    ++(*chunk.counts)[message.topic];
    chunk.first_ns = std::min(chunk.first_ns, message.received_ns);
    chunk.last_ns = std::max(chunk.last_ns, message.received_ns);
  }
  if (damage && loaded.messages.empty()) throw Refusal(*damage);
  // Reported now: what is read later may pass over the chunk.
  if (damage) {
    chunk.damaged = true;
    bag.index.damage.push_back(damage_of(chunk, *bag.file, *damage));
  }
  if (!loaded.messages.empty()) bag.index.chunks.push_back(std::move(chunk));
}

// The index is missing: every chunk is unpacked once to learn what it holds.
void look_through(Opening& bag, std::uint64_t offset) {
  std::vector<std::byte> buffer;
  LoadedChunk loaded;
  bool chunk_reports_the_cut = false;
  try {
    while (offset < bag.file->size()) {
      Bytes header_bytes;
      const RecordPlace place = locate_record(*bag.file, offset, buffer, header_bytes);
      const auto op = RecordHeader(header_bytes).number<std::uint8_t>("op");
      if (op == chunk_record) look_through_chunk(bag, offset, loaded);
      if (op == connection && place.end() <= bag.file->size()) {
        std::vector<std::byte> record_bytes;
        ByteCursor cursor(bag.file->read(offset, place.end() - offset, record_bytes));
        bag.connections.add(read_record(cursor), bag.index.topics);
      }
      chunk_reports_the_cut = !bag.index.chunks.empty() && bag.index.chunks.back().offset == offset;
      offset = place.end();
    }
    if (offset > bag.file->size() && !chunk_reports_the_cut) {
      throw Refusal(refusal_reason::truncated, "the file ends inside of a record");
    }
  } catch (const Refusal& refusal) {
    bag.index.damage.push_back({refusal.reason(),
                                bag.file->path().string() + ": at byte " + std::to_string(offset) +
                                    ": " + refusal.what() + "; what came before is read"});
  }
}

void require_bag(const ContainerFile& file, Bytes start) {
  const std::string_view text = text_of(start);
  if (text.starts_with(magic)) return;
  if (text.starts_with("#ROSBAG V1")) {
    throw input_error(file.path(),
                      "a ROS bag of version 1; convert it with 'rosbag migrate' or 'rosbag fix'");
  }
  throw input_error(file.path(),
                    file.size() == 0 ? "has 0 bytes; copy it anew" : "is not a ROS 1 bag");
}

}  // namespace

std::unique_ptr<MessageSource> open_ros1_bag(const std::filesystem::path& path) {
  Opening bag{std::make_shared<ContainerFile>(path), {}, {}};
  std::vector<std::byte> buffer;
  require_bag(*bag.file, bag.file->read(0, magic.size(), buffer));
  std::uint64_t index_offset = 0;
  std::uint64_t chunk_count = 0;
  std::uint64_t first_record = 0;
  try {
    Bytes header_bytes;
    const RecordPlace place = locate_record(*bag.file, magic.size(), buffer, header_bytes);
    const RecordHeader header(header_bytes);
    if (header.number<std::uint8_t>("op") != bag_header) {
      throw Refusal(refusal_reason::broken_header, "its first record is not a bag header");
    }
    if (header.has("encryptor") && !header.text("encryptor").empty()) {
      throw input_error(path, "an encrypted bag; decrypt it with 'rosbag decrypt'");
    }
    index_offset = header.number<std::uint64_t>("index_pos");
    chunk_count = header.number<std::uint32_t>("chunk_count");
    first_record = place.end();
  } catch (const Refusal& refusal) {
    throw input_error(path, std::string("broken at its beginning: ") + refusal.what());
  }
  bool indexed = false;
  if (index_offset >= first_record && index_offset <= bag.file->size()) {
    try {
      read_index(bag, index_offset, chunk_count);
      indexed = true;
    } catch (const Refusal&) {
      bag.index = {};
      bag.connections = {};
    }
  }
  if (!indexed) {
    bag.index.notes.push_back(path.filename().string() +
                              " has no index, the recorder was stopped early or the file cut: "
                              "looked through as a whole");
    look_through(bag, first_record);
  }
  sum_counts(bag.index);
  auto reader = std::make_unique<Ros1ChunkReader>(bag.file, std::move(bag.connections));
  return std::make_unique<ChunkedSource>(bag.file, std::move(bag.index), std::move(reader));
}

}  // namespace kissmap
