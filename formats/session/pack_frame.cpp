// SPDX-License-Identifier: MIT
#include "formats/session/pack_frame.hpp"

#include "formats/files/xxh3.hpp"
#include "kissmap/formats/pack.hpp"

namespace kissmap {
namespace {

// The line end shows at once when a pack went through a transfer that changes texts.
constexpr std::string_view pack_magic = "KMPACK\r\n";
constexpr std::uint32_t pack_version = 1;
constexpr std::uint32_t frame_magic = 0x52464D4B;  // "KMFR"

// zstd stores no block of 128 KiB in fewer than 4 bytes.
constexpr std::uint64_t max_expansion = 1 << 15;

std::string with_checksum(const ByteWriter& bytes) {
  ByteWriter sum;
  sum.value(xxh3_64(bytes.bytes()));
  return bytes.bytes() + sum.bytes();
}

// Also the first thing to look at, so that nothing is concluded from damaged bytes.
bool checksum_holds(std::string_view bytes) {
  const std::size_t size = bytes.size() - sizeof(std::uint64_t);
  return ByteReader(bytes.substr(size)).value<std::uint64_t>() == xxh3_64(bytes.substr(0, size));
}

}  // namespace

std::string pack_header() {
  ByteWriter bytes;
  for (const char character : pack_magic) bytes.value(character);
  bytes.value(pack_version);
  bytes.value(std::uint32_t{0});
  bytes.value(pack_resolution);
  return with_checksum(bytes);
}

bool is_pack_start(std::string_view bytes) {
  return bytes.starts_with(pack_magic);
}

void require_pack_header(std::string_view bytes) {
  if (bytes.size() < pack_header_size || !is_pack_start(bytes)) {
    throw DamagedPack("is no pack of kissmap");
  }
  ByteReader reader(bytes.substr(pack_magic.size()));
  const auto version = reader.value<std::uint32_t>();
  if (!checksum_holds(bytes.substr(0, pack_header_size))) {
    throw DamagedPack("has a damaged file header");
  }
  if (version != pack_version) {
    throw DamagedPack("has pack version " + std::to_string(version) + ", this program reads " +
                      std::to_string(pack_version) + "; use a newer kissmap");
  }
  reader.value<std::uint32_t>();
  if (reader.value<double>() != pack_resolution) throw DamagedPack("has an unknown resolution");
}

std::string frame_header(const FrameHeader& header) {
  ByteWriter bytes;
  bytes.value(frame_magic);
  bytes.value(static_cast<std::uint32_t>(header.kind));
  bytes.value(header.index);
  bytes.value(header.unpacked_size);
  bytes.value(header.stored_size);
  bytes.value(header.stored_xxh3);
  return with_checksum(bytes);
}

FrameHeader parse_frame_header(std::string_view bytes) {
  if (bytes.size() != frame_header_size || !checksum_holds(bytes)) {
    throw DamagedPack("a frame header is damaged");
  }
  ByteReader reader(bytes);
  const bool is_frame = reader.value<std::uint32_t>() == frame_magic;
  const auto kind = reader.value<std::uint32_t>();
  if (!is_frame || kind < 1 || kind > 3) throw DamagedPack("a frame is of an unknown kind");
  FrameHeader header;
  header.kind = static_cast<FrameKind>(kind);
  header.index = reader.value<std::uint64_t>();
  header.unpacked_size = reader.value<std::uint32_t>();
  header.stored_size = reader.value<std::uint32_t>();
  header.stored_xxh3 = reader.value<std::uint64_t>();
  if (header.unpacked_size > max_unpacked_size ||
      header.unpacked_size > header.stored_size * max_expansion) {
    throw DamagedPack("a frame has an impossible size");
  }
  return header;
}

}  // namespace kissmap
