// SPDX-License-Identifier: MIT
// Layout: mcap.dev/spec.
#include <libdeflate.h>
#include <lz4frame.h>
#include <zstd.h>

#include <algorithm>
#include <fstream>

#include "bench/byte_text.hpp"
#include "bench/recorded_logs.hpp"

namespace kissmap {
namespace {

constexpr std::string_view magic("\x89MCAP0\r\n", 8);

std::string mcap_record(std::uint8_t op, std::string_view content) {
  return ByteText()
      .add<std::uint8_t>(op)
      .add<std::uint64_t>(content.size())
      .add_text(content)
      .text();
}

std::string packed(std::string_view bytes, std::string_view compression) {
  if (compression.empty()) return std::string(bytes);
  std::string out(
      std::max(ZSTD_compressBound(bytes.size()), LZ4F_compressFrameBound(bytes.size(), nullptr)),
      '\0');
  out.resize(compression == "zstd"
                 ? ZSTD_compress(out.data(), out.size(), bytes.data(), bytes.size(), 1)
                 : LZ4F_compressFrame(out.data(), out.size(), bytes.data(), bytes.size(), nullptr));
  return out;
}

std::string mcap_definitions() {
  const std::string schema =
      ByteText().add<std::uint16_t>(1).add_block("sensor_msgs/msg/PointCloud2").text();
  const std::string channel = ByteText().add<std::uint16_t>(1).add<std::uint16_t>(1).text();
  return mcap_record(3, schema + ByteText().add_block("ros2msg").add_block("").text()) +
         mcap_record(
             4, channel + ByteText().add_block("/points").add_block("cdr").add_block("").text());
}

std::string mcap_chunk(std::uint64_t time, std::string_view records, const McapOptions& options) {
  const std::uint32_t checksum = libdeflate_crc32(0, records.data(), records.size());
  const std::string body = packed(records, options.compression);
  ByteText content;
  content.add<std::uint64_t>(time).add<std::uint64_t>(time).add<std::uint64_t>(records.size());
  content.add<std::uint32_t>(options.checksums ? checksum : 0).add_block(options.compression);
  return mcap_record(6, content.add<std::uint64_t>(body.size()).add_text(body).text());
}

}  // namespace

void write_mcap(const std::filesystem::path& path,
                const RecordedClouds& clouds,
                const McapOptions& options) {
  std::ofstream file(path, std::ios::binary);
  file << magic << mcap_record(1, ByteText().add_block("ros2").add_block("bench").text());
  const std::string definitions = mcap_definitions();
  std::string indexes;
  for (std::size_t i = 0; i < clouds.count; ++i) {
    const std::uint64_t time = recorded_ns(i);
    ByteText message;
    message.add<std::uint16_t>(1).add<std::uint32_t>(static_cast<std::uint32_t>(i));
    message.add<std::uint64_t>(time).add<std::uint64_t>(time);
    message.add_text(cloud_message(clouds, i, true));
    const std::string records = (i == 0 ? definitions : "") + mcap_record(5, message.text());
    const std::string chunk = mcap_chunk(time, records, options);
    const auto offset = static_cast<std::uint64_t>(file.tellp());
    file << chunk;
    ByteText entry;  // without an index of messages
    entry.add<std::uint64_t>(time).add<std::uint64_t>(time).add<std::uint64_t>(offset);
    entry.add<std::uint64_t>(chunk.size()).add_block("").add<std::uint64_t>(0);
    entry.add_block(options.compression).add<std::uint64_t>(chunk.size());
    indexes += mcap_record(8, entry.add<std::uint64_t>(records.size()).text());
  }
  file << mcap_record(15, ByteText().add<std::uint32_t>(0).text());
  const auto summary = static_cast<std::uint64_t>(file.tellp());
  file << definitions << indexes
       << mcap_record(2,
                      ByteText()
                          .add<std::uint64_t>(summary)
                          .add<std::uint64_t>(0)
                          .add<std::uint32_t>(0)
                          .text())
       << magic;
}

}  // namespace kissmap
