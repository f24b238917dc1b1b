// SPDX-License-Identifier: MIT
#pragma once

#include <deque>
#include <map>
#include <memory>

#include "formats/clouds/refusal.hpp"
#include "formats/containers/container_file.hpp"
#include "formats/containers/message_source.hpp"

namespace kissmap {

/// A part of a container that is read at once.
struct Chunk {
  std::uint64_t offset = 0;
  std::uint64_t size = 0;  ///< of its records in the file
  std::int64_t first_ns = 0;
  std::int64_t last_ns = 0;
  bool bare = false;     ///< messages that lie in the file without a chunk around them
  bool damaged = false;  ///< as was seen and reported when it was counted
  /// How many messages of each topic it holds; without it only unpacking can tell.
  std::optional<std::map<std::size_t, std::uint64_t>> counts;
};

/// A message in a chunk.
struct StoredMessage {
  std::size_t topic = 0;
  std::int64_t received_ns = 0;
  std::size_t offset = 0;  ///< of its data, in the chunk's bytes
  std::size_t size = 0;
};

struct LoadedChunk {
  std::vector<std::byte> bytes;
  std::vector<StoredMessage> messages;
};

/// What is known of a container once it was opened.
struct ContainerIndex {
  std::vector<Topic> topics;
  std::vector<Chunk> chunks;  ///< in the file's order
  std::optional<std::pair<std::int64_t, std::int64_t>> time_range;
  std::vector<ContainerDamage> damage;
  std::vector<std::string> notes;
};

/// What is reported of a chunk that cannot be read to its end.
ContainerDamage damage_of(const Chunk& chunk, const ContainerFile& file, const Refusal& why);

/// Counts of topics and the range of times from those of the chunks, all of which have counts.
void sum_counts(ContainerIndex& index);

/// How one kind of container stores its chunks.
class ChunkReader {
 public:
  virtual ~ChunkReader() = default;

  /// Reads a chunk. `to` holds all of it, or after a Refusal the messages before the damage.
  virtual void load(const Chunk& chunk, LoadedChunk& to) = 0;

  /// Appends the times of a topic's messages and takes the size of the index read off `most_bytes`;
  /// false where no index tells, or where it is larger. Never throws for damage.
  virtual bool append_times(const Chunk& chunk,
                            std::size_t topic,
                            std::vector<std::int64_t>& to,
                            std::uint64_t& most_bytes) = 0;

  /// Fills in chunk.counts if that is possible without unpacking. Never throws for damage.
  virtual void count(Chunk& chunk) = 0;
};

/// Messages of a container made of chunks, merged where the chunks' times overlap.
class ChunkedSource : public MessageSource {
 public:
  ChunkedSource(std::shared_ptr<const ContainerFile> file,
                ContainerIndex index,
                std::unique_ptr<ChunkReader> reader);

  const std::vector<Topic>& topics() const override { return index_.topics; }
  std::optional<std::pair<std::int64_t, std::int64_t>> time_range() const override {
    return index_.time_range;
  }
  std::optional<std::vector<std::int64_t>> times(std::size_t topic,
                                                 std::uint64_t most_bytes) override;
  void select(const std::set<std::size_t>& topics) override { selected_ = topics; }
  bool next(Message& message) override;
  std::uint64_t skip(std::uint64_t count) override;
  const std::vector<ContainerDamage>& damage() const override { return index_.damage; }
  std::vector<LogFile> files() const override { return {file_->log_file()}; }
  std::vector<std::string> notes() const override { return index_.notes; }

 private:
  struct Open {
    LoadedChunk chunk;
    std::size_t position = 0;  ///< of the next message
    std::int64_t next_ns() const { return chunk.messages[position].received_ns; }
  };

  bool open_next_chunk();
  Open* earliest();
  void recycle_finished();
  bool stands_alone(std::size_t chunk) const;
  std::optional<std::uint64_t> selected_in(Chunk& chunk);

  std::shared_ptr<const ContainerFile> file_;
  ContainerIndex index_;
  std::unique_ptr<ChunkReader> reader_;
  std::set<std::size_t> selected_;
  std::deque<Open> open_;
  std::vector<LoadedChunk> spare_;
  std::size_t next_chunk_ = 0;
};

}  // namespace kissmap
