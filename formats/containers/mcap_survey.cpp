// SPDX-License-Identifier: MIT
#include <algorithm>
#include <utility>

#include "formats/containers/mcap_records.hpp"

namespace kissmap::mcap {
namespace {

constexpr std::uint64_t message_head = 22;         // bytes before the data
constexpr std::uint64_t bare_run_bytes = 4 << 20;  // messages outside of chunks are read so many

/// Counts what a file without a summary holds, chunk by chunk.
class Survey {
 public:
  explicit Survey(Opening& opening) : opening_(opening) {}

  void run() {
    std::uint64_t offset = magic.size();
    const std::uint64_t size = opening_.file->size();
    try {
      while (offset < size) {
        ByteCursor head(opening_.file->read(offset, record_head + message_head, buffer_));
        const auto op = head.value<std::uint8_t>();
        const auto length = head.value<std::uint64_t>();
        const bool whole = length <= size - std::min(size, offset + record_head);
        if (op == data_end || op == footer) return finish_run();
        if (op == chunk_record) {
          look_through_chunk(offset, std::min(length, size) + record_head);
          if (!whole) return;  // reported for the chunk
        } else if (!whole) {
          throw Refusal(refusal_reason::truncated, "the file ends inside of a record");
        } else if (op == message_record) {
          add_bare_message(offset, length, head);
        } else if (op == schema || op == channel) {
          add_definition(op, opening_.file->read(offset + record_head, length, buffer_));
        }
        offset += record_head + length;
      }
      throw Refusal(refusal_reason::truncated, "the file ends without the mark of its end");
    } catch (const Refusal& refusal) {
      finish_run();
      opening_.index.damage.push_back({refusal.reason(),
                                       opening_.file->path().string() + ": at byte " +
                                           std::to_string(offset) + ": " + refusal.what() +
                                           "; what came before is read"});
    }
  }

 private:
  void add_definition(std::uint8_t op, Bytes content) {
    if (op == schema) opening_.channels.add_schema(content);
    if (op == channel) opening_.channels.add_channel(content, opening_.index.topics);
  }

  void count(Chunk& chunk, std::size_t topic, std::int64_t logged_ns) {
    if (!chunk.counts) chunk.counts.emplace();
    if (chunk.counts->empty()) chunk.first_ns = chunk.last_ns = logged_ns;
    ++(*chunk.counts)[topic];
    chunk.first_ns = std::min(chunk.first_ns, logged_ns);
    chunk.last_ns = std::max(chunk.last_ns, logged_ns);
  }

  void add_bare_message(std::uint64_t offset, std::uint64_t length, ByteCursor& head) {
    const auto topic = opening_.channels.topic(head.value<std::uint16_t>());
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
    if (run_.size > 0) opening_.index.chunks.push_back(std::exchange(run_, Chunk()));
  }

  void look_through_chunk(std::uint64_t offset, std::uint64_t size) {
    finish_run();
    Chunk chunk;
    chunk.offset = offset;
    chunk.size = size;
    std::optional<Refusal> damage;
    try {
      load_chunk(*opening_.file, chunk, buffer_, loaded_.bytes);
    } catch (const Refusal& refusal) {
      damage = refusal;
    }
    loaded_.messages.clear();
    try {
      find_messages(loaded_, opening_.channels, &opening_.index.topics);
    } catch (const Refusal& refusal) {
      if (!damage) damage = refusal;
    }
    for (const StoredMessage& message : loaded_.messages) {
      count(chunk, message.topic, message.received_ns);
    }
    // Reported now: what is read later may pass over the chunk.
    if (chunk.counts && damage) {
      chunk.damaged = true;
      opening_.index.damage.push_back(damage_of(chunk, *opening_.file, *damage));
    }
    if (chunk.counts) {
      opening_.index.chunks.push_back(std::move(chunk));
    } else if (damage) {
      throw Refusal(*damage);
    }
  }

  Opening& opening_;
  Chunk run_;  // messages outside of chunks, one behind the other; of no size if there is none
  LoadedChunk loaded_;
  std::vector<std::byte> buffer_;
};

}  // namespace

void survey(Opening& opening) {
  Survey(opening).run();
  sum_counts(opening.index);
}

}  // namespace kissmap::mcap
