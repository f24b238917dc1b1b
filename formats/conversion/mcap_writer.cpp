// SPDX-License-Identifier: MIT
#include "formats/conversion/mcap_writer.hpp"

#include <libdeflate.h>
#include <zstd.h>

#include <algorithm>
#include <bit>
#include <cstring>
#include <type_traits>
#include <utility>

#include "formats/containers/mcap_records.hpp"
#include "kissmap/error.hpp"
#include "kissmap/version.hpp"

namespace kissmap {
namespace {

static_assert(std::endian::native == std::endian::little);

constexpr std::size_t chunk_bytes = 4 << 20;
constexpr int zstd_level = 1;
constexpr std::uint16_t channel_id = 1;
constexpr std::uint16_t schema_id = 1;

template <class T>
requires std::is_integral_v<T> std::string raw(T value) {
  std::string bytes(sizeof(T), '\0');
  std::memcpy(bytes.data(), &value, sizeof(T));
  return bytes;
}

std::string text(std::string_view value) {
  return raw(static_cast<std::uint32_t>(value.size())) + std::string(value);
}

std::string record(mcap::Op op, std::string_view content) {
  return raw(static_cast<std::uint8_t>(op)) + raw(std::uint64_t{content.size()}) +
         std::string(content);
}

std::uint32_t checksum_of(std::uint32_t before, std::string_view bytes) {
  return libdeflate_crc32(before, bytes.data(), bytes.size());
}

std::string packed(std::string_view bytes, const std::filesystem::path& path) {
  std::string out(ZSTD_compressBound(bytes.size()), '\0');
  const std::size_t size =
      ZSTD_compress(out.data(), out.size(), bytes.data(), bytes.size(), zstd_level);
  if (ZSTD_isError(size) != 0U) throw output_error(path, ZSTD_getErrorName(size));
  out.resize(size);
  return out;
}

}  // namespace

McapWriter::McapWriter(const std::filesystem::path& path, McapChannel channel)
    : file_(path), channel_(std::move(channel)) {
  put(mcap::magic);
  put(record(mcap::header, text(channel_.profile) + text(std::string("kissmap ") + version())));
}

void McapWriter::put(std::string_view bytes) {
  file_.write(bytes);
  checksum_ = checksum_of(checksum_, bytes);
  offset_ += bytes.size();
}

std::string McapWriter::definitions() const {
  return record(mcap::schema,
                raw(schema_id) + text(channel_.schema_name) + text(channel_.schema_encoding) +
                    text(channel_.schema)) +
         record(mcap::channel,
                raw(channel_id) + raw(schema_id) + text(channel_.topic) +
                    text(channel_.message_encoding) + raw(std::uint32_t{0}));
}

void McapWriter::add(std::int64_t time_ns, std::string_view bytes) {
  // The format has no times before 1970.
  const auto time = static_cast<std::uint64_t>(std::max<std::int64_t>(time_ns, 0));
  if (chunk_.empty()) {
    if (chunks_.empty()) chunk_ = definitions();
    current_.first_ns = current_.last_ns = time;
  }
  current_.first_ns = std::min(current_.first_ns, time);
  current_.last_ns = std::max(current_.last_ns, time);
  index_ += raw(time) + raw(std::uint64_t{chunk_.size()});
  chunk_ += raw(static_cast<std::uint8_t>(mcap::message_record)) +
            raw(std::uint64_t{bytes.size() + 22}) + raw(channel_id) +
            raw(static_cast<std::uint32_t>(messages_++)) + raw(time) + raw(time);
  chunk_ += bytes;
  if (chunk_.size() >= chunk_bytes) write_chunk();
}

void McapWriter::write_chunk() {
  if (chunk_.empty()) return;
  const std::string body = packed(chunk_, file_.path());
  current_.offset = offset_;
  current_.packed_size = body.size();
  current_.unpacked_size = chunk_.size();
  put(record(mcap::chunk_record,
             raw(current_.first_ns) + raw(current_.last_ns) + raw(current_.unpacked_size) +
                 raw(checksum_of(0, chunk_)) + text("zstd") + raw(current_.packed_size) + body));
  current_.size = offset_ - current_.offset;
  current_.index_offset = offset_;
  put(record(mcap::message_index, raw(channel_id) + text(index_)));
  current_.index_size = offset_ - current_.index_offset;
  chunks_.push_back(std::exchange(current_, ChunkEntry()));
  chunk_.clear();
  index_.clear();
}

std::string McapWriter::statistics() const {
  std::uint64_t first = chunks_.empty() ? 0 : chunks_.front().first_ns;
  std::uint64_t last = 0;
  for (const ChunkEntry& entry : chunks_) {
    first = std::min(first, entry.first_ns);
    last = std::max(last, entry.last_ns);
  }
  return record(mcap::statistics,
                raw(messages_) + raw(std::uint16_t{1}) + raw(std::uint32_t{1}) +
                    raw(std::uint32_t{0}) + raw(std::uint32_t{0}) +
                    raw(static_cast<std::uint32_t>(chunks_.size())) + raw(first) + raw(last) +
                    text(raw(channel_id) + raw(messages_)));
}

void McapWriter::finish() {
  write_chunk();
  const std::uint32_t data_checksum = checksum_;
  put(record(mcap::data_end, raw(data_checksum)));
  const std::uint64_t summary_start = offset_;
  std::string offsets;
  checksum_ = 0;  // from here on, of the summary
  const auto put_group = [&](mcap::Op op, const std::string& records) {
    offsets += record(
        mcap::summary_offset,
        raw(static_cast<std::uint8_t>(op)) + raw(offset_) + raw(std::uint64_t{records.size()}));
    put(records);
  };
  const std::string both = definitions();
  const std::size_t schema_size = 9 + 2 + 4 + channel_.schema_name.size() + 4 +
                                  channel_.schema_encoding.size() + 4 + channel_.schema.size();
  put_group(mcap::schema, both.substr(0, schema_size));
  put_group(mcap::channel, both.substr(schema_size));
  put_group(mcap::statistics, statistics());
  std::string indexes;
  for (const ChunkEntry& entry : chunks_) {
    indexes +=
        record(mcap::chunk_index,
               raw(entry.first_ns) + raw(entry.last_ns) + raw(entry.offset) + raw(entry.size) +
                   text(raw(channel_id) + raw(entry.index_offset)) + raw(entry.index_size) +
                   text("zstd") + raw(entry.packed_size) + raw(entry.unpacked_size));
  }
  if (!indexes.empty()) put_group(mcap::chunk_index, indexes);
  const std::uint64_t offsets_start = offset_;
  put(offsets);
  put(raw(static_cast<std::uint8_t>(mcap::footer)) + raw(std::uint64_t{20}) + raw(summary_start) +
      raw(offsets_start));
  const std::uint32_t summary_checksum = checksum_;
  put(raw(summary_checksum) + std::string(mcap::magic));
  file_.publish(mcap::magic);
}

}  // namespace kissmap
