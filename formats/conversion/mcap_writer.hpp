// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "formats/files/aside_file.hpp"

namespace kissmap {

/// What the one channel of a file is.
struct McapChannel {
  std::string topic;
  std::string schema_name;
  std::string schema_encoding;
  std::string schema;
  std::string message_encoding;
  std::string profile;
};

/// An MCAP file with one channel, in chunks packed with zstd, with an index and check sums. Layout:
/// mcap.dev/spec. Throws Error(output) naming the file.
class McapWriter {
 public:
  McapWriter(const std::filesystem::path& path, McapChannel channel);

  void add(std::int64_t time_ns, std::string_view message);
  void finish();

 private:
  struct ChunkEntry {
    std::uint64_t first_ns = 0;
    std::uint64_t last_ns = 0;
    std::uint64_t offset = 0;
    std::uint64_t size = 0;
    std::uint64_t index_offset = 0;
    std::uint64_t index_size = 0;
    std::uint64_t packed_size = 0;
    std::uint64_t unpacked_size = 0;
  };

  void put(std::string_view bytes);
  void write_chunk();
  std::string definitions() const;
  std::string statistics() const;

  AsideFile file_;
  McapChannel channel_;
  std::uint64_t offset_ = 0;
  std::uint32_t checksum_ = 0;  ///< of all bytes so far
  std::string chunk_;
  std::string index_;  ///< times and offsets of the chunk's messages
  std::vector<ChunkEntry> chunks_;
  ChunkEntry current_;
  std::uint64_t messages_ = 0;
};

}  // namespace kissmap
