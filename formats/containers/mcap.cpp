// SPDX-License-Identifier: MIT
#include "formats/containers/mcap.hpp"

#include "formats/containers/mcap_records.hpp"
#include "formats/text/lines.hpp"
#include "kissmap/error.hpp"

namespace kissmap {
namespace {

using namespace mcap;

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

  bool append_times(const Chunk& chunk,
                    std::size_t topic,
                    std::vector<std::int64_t>& to,
                    std::uint64_t& most_bytes) override {
    const auto places = indexes_.find(chunk.offset);
    if (chunk.bare || places == indexes_.end()) return false;
    try {
      for (const std::uint64_t place : places->second) {
        if (!append_times(place, topic, to, most_bytes)) return false;
      }
    } catch (const Refusal&) {
      return false;
    }
    return true;
  }

 private:
  // Of one message index: channel, then time and offset of each message.
  bool append_times(std::uint64_t place,
                    std::size_t topic,
                    std::vector<std::int64_t>& to,
                    std::uint64_t& most_bytes) {
    constexpr std::size_t head_bytes = record_head + 6;
    ByteCursor head(file_->read(place, head_bytes, buffer_));
    if (head.value<std::uint8_t>() != message_index) return false;
    head.value<std::uint64_t>();
    const bool wanted = channels_.topic(head.value<std::uint16_t>()) == topic;
    const std::uint64_t size = wanted ? head.value<std::uint32_t>() : 0;
    if (head_bytes + size > most_bytes) return false;
    most_bytes -= head_bytes + size;
    ByteCursor entries(file_->read(place + head_bytes, size, buffer_));
    for (std::uint64_t left = size / 16; left > 0; --left) {
      to.push_back(time_of(entries.value<std::uint64_t>()));
      entries.value<std::uint64_t>();
    }
    return true;
  }

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

}  // namespace

std::unique_ptr<MessageSource> open_mcap(const std::filesystem::path& path) {
  Opening opening;
  opening.file = std::make_shared<ContainerFile>(path);
  std::vector<std::byte> buffer;
  if (text_of(opening.file->read(0, magic.size(), buffer)) != magic) {
    throw input_error(
        path, opening.file->size() == 0 ? "has 0 bytes; copy it anew" : "is not an MCAP file");
  }
  bool summarised = false;
  try {
    summarised = use_summary(opening);
  } catch (const Refusal&) {
    // Looked through below.
  }
  if (!summarised) {
    opening = Opening{opening.file, {}, {}, {}, {}};
    opening.index.notes.push_back(path.filename().string() +
                                  " has no summary of its chunks: looked through as a whole");
    survey(opening);
  }
  auto reader = std::make_unique<McapChunkReader>(
      opening.file, std::move(opening.channels), std::move(opening.indexes));
  return std::make_unique<ChunkedSource>(opening.file, std::move(opening.index), std::move(reader));
}

}  // namespace kissmap
