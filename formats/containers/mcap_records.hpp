// SPDX-License-Identifier: MIT
#pragma once

#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "formats/containers/byte_cursor.hpp"
#include "formats/containers/chunked_source.hpp"

/// Records of MCAP files (mcap.dev/spec), for the files mcap*.cpp alone. All that reads throws
/// Refusal where the bytes end or contradict the specification.
namespace kissmap::mcap {

using Bytes = std::span<const std::byte>;

inline constexpr std::string_view magic = "\x89MCAP0\r\n";
inline constexpr std::uint64_t record_head = 9;  // bytes: opcode and length

enum Op : std::uint8_t {
  header = 0x01,
  footer = 0x02,
  schema = 0x03,
  channel = 0x04,
  message_record = 0x05,
  chunk_record = 0x06,
  message_index = 0x07,
  chunk_index = 0x08,
  statistics = 0x0B,
  summary_offset = 0x0E,
  data_end = 0x0F
};

struct Record {
  std::uint8_t op = 0;
  Bytes content;
};

Record read_record(ByteCursor& cursor);
std::int64_t time_of(std::uint64_t ns);

/// Schemas and channels by number, and the topics they belong to.
class Channels {
 public:
  void add_schema(Bytes content);
  void add_channel(Bytes content, std::vector<Topic>& topics);
  std::optional<std::size_t> topic(std::uint16_t id) const;

 private:
  std::map<std::uint16_t, std::string> schema_names_;
  std::map<std::uint16_t, std::size_t> topic_of_;
};

/// The messages among the records of a chunk. Topics that appear are added to `topics` where that
/// is given; messages of unknown channels are left out.
void find_messages(LoadedChunk& chunk, Channels& channels, std::vector<Topic>* topics);

/// The records of a chunk, or what can be had of them before a Refusal.
void load_chunk(const ContainerFile& file,
                const Chunk& chunk,
                std::vector<std::byte>& buffer,
                std::vector<std::byte>& out);

/// What is found out while a file is opened.
struct Opening {
  std::shared_ptr<const ContainerFile> file;
  ContainerIndex index;
  Channels channels;
  std::map<std::uint64_t, std::vector<std::uint64_t>> indexes;  ///< of messages, by chunk
  std::optional<std::uint64_t> messages_told;                   ///< by the statistics
};

/// Fills in what the summary at the end of the file tells; true where that is all that is needed.
bool use_summary(Opening& opening);

/// Looks through a file without a summary, chunk by chunk.
void survey(Opening& opening);

}  // namespace kissmap::mcap
